#include "resident_runs.hpp"

#include "stopwatch.hpp"

namespace pointskin::cli {

std::vector<ResidentRun> run_resident(Reconstructor& reconstructor, const Cloud& cloud, const Options& options,
                                      int times) {
  const Workspace workspace = reconstructor.workspace();
  const UploadedCloud points = upload(workspace, cloud);
  std::vector<ResidentRun> runs;
  for (int i = 0; i < times; ++i) {
    workspace.synchronize();
    const Stopwatch watch;
    const DeviceMesh mesh = reconstructor.reconstruct(points, options);
    workspace.synchronize();
    const RunReport& report = reconstructor.report();
    ResidentRun run{report.octree_ms, report.splat_ms, report.solve_ms};
    run.total_ms = watch.ms();
    run.extract_ms = run.total_ms - run.octree_ms - run.splat_ms - run.solve_ms;
    run.vertices = mesh.vertices.size;
    run.triangles = mesh.triangles.size;
    runs.push_back(run);
  }
  return runs;
}

}  // namespace pointskin::cli
