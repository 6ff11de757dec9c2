#include <pointskin/reconstruct.hpp>

#include <cstdint>
#include <vector>

#include "c/convert.hpp"
#include "c/defaults.hpp"
#include "c/points_input.hpp"

using namespace pointskin;
using namespace pointskin::c;

namespace {

/// What the report points to, kept until the next run.
void keep_lists(psk_reconstructor& handle) {
  const RunReport& report = handle.reconstructor.report();
  handle.warnings.clear();
  for (const Warning& warning : report.warnings)
    handle.warnings.push_back({name_of(warning.kind), warning.text.c_str(), warning.share});
  handle.levels.clear();
  for (const LevelReport& level : report.levels)
    handle.levels.push_back(
        {level.nodes, level.unknowns, level.residual_before, level.residual_after, level.depth, level.iterations});
}

void set_counts(const RunReport& from, psk_run_report& to) {
  to.points = from.points;
  to.strays = from.strays;
  to.nodes = from.nodes;
  to.depth = from.depth;
  to.isovalue = from.isovalue;
  to.upload_ms = from.upload_ms;
  to.octree_ms = from.octree_ms;
  to.splat_ms = from.splat_ms;
  to.solve_ms = from.solve_ms;
  to.extract_ms = from.extract_ms;
  to.download_ms = from.download_ms;
  to.device_peak_bytes = from.device_peak_bytes;
}

void set_changes(const RunReport& from, psk_run_report& to) {
  to.trim_quantile = from.trim.quantile;
  to.trim_density = from.trim.density;
  to.trim_area_before = from.trim.area_before;
  to.trim_area_removed = from.trim.area_removed;
  to.trim_triangles_before = from.trim.triangles_before;
  to.trim_triangles_removed = from.trim.triangles_removed;
  to.trim_triangles_split = from.trim.triangles_split;
  to.trim_islands_removed = from.trim.islands_removed;
  to.trim_holes_filled = from.trim.holes_filled;
  to.pieces = from.pieces.pieces;
  to.pieces_removed = from.pieces.pieces_removed;
  to.pieces_triangles_removed = from.pieces.triangles_removed;
  to.envelope_samples_outside = from.envelope.samples_outside;
  to.envelope_vertices_moved = from.envelope.vertices_moved;
  to.envelope_farthest_move = from.envelope.farthest_move;
  to.offset_cells = from.offset.cells;
  to.offset_cube_growth = from.offset.cube_growth;
  to.offset_ms = from.offset.ms;
}

/// Runs f, which works with the reconstructor, and keeps what its report points to.
template <class F>
void run(psk_reconstructor* handle, const F& f) {
  psk_reconstructor& target = required(handle, "reconstructor");
  f(target.reconstructor);
  keep_lists(target);
}

}  // namespace

psk_code psk_reconstructor_create(psk_workspace* workspace, psk_reconstructor** reconstructor, psk_error* error) {
  return guarded(error, [&] {
    required(reconstructor, "reconstructor") = new psk_reconstructor(required(workspace, "workspace").workspace);
  });
}

void psk_reconstructor_free(psk_reconstructor* reconstructor) { delete reconstructor; }

psk_code psk_reconstruct(psk_reconstructor* reconstructor, const psk_cloud* cloud, const psk_options* options,
                         psk_mesh** mesh, psk_error* error) {
  return guarded(error, [&] {
    run(reconstructor, [&](Reconstructor& r) {
      required(mesh, "mesh") = new_mesh(r.reconstruct(required(cloud, "cloud").cloud, options_of(options)));
    });
  });
}

psk_code psk_reconstruct_points(psk_reconstructor* reconstructor, const psk_points* points, const psk_options* options,
                                int32_t memory, psk_mesh** mesh, psk_error* error) {
  return guarded(error, [&] {
    run(reconstructor, [&](Reconstructor& r) {
      with_device_points(r.workspace(), points, [&](const DevicePoints& input) {
        required(mesh, "mesh") = new_mesh(r.workspace(), r.reconstruct(input, options_of(options)), memory);
      });
    });
  });
}

psk_code psk_reconstructor_report(const psk_reconstructor* reconstructor, psk_run_report* report, psk_error* error) {
  return guarded(error, [&] {
    const psk_reconstructor& handle = required(reconstructor, "reconstructor");
    const RunReport& from = handle.reconstructor.report();
    auto to = defaults<psk_run_report>();
    to.warnings = handle.warnings.data();
    to.warning_count = static_cast<std::int64_t>(handle.warnings.size());
    to.levels = handle.levels.data();
    to.level_count = static_cast<std::int64_t>(handle.levels.size());
    to.normals_done = name_of(from.normals_done);
    set_counts(from, to);
    set_changes(from, to);
    give(to, &required(report, "report"));
  });
}

psk_code psk_estimate_device_bytes(const psk_cloud* cloud, const psk_options* options, int32_t threads, int64_t* bytes,
                                   psk_error* error) {
  return guarded(error, [&] {
    required(bytes, "bytes") = estimate_device_bytes(required(cloud, "cloud").cloud, options_of(options), threads);
  });
}

psk_code psk_suggest_depth(psk_workspace* workspace, const psk_cloud* cloud, const psk_options* options,
                           psk_depth_suggestion* suggestion, psk_error* error) {
  return guarded(error, [&] {
    const DepthSuggestion from = suggest_depth(required(cloud, "cloud").cloud, options_of(options),
                                               required(workspace, "workspace").workspace.device());
    auto to = defaults<psk_depth_suggestion>();
    to.spacing = from.spacing;
    to.noise = from.noise;
    to.depth = from.depth;
    to.supported = from.supported;
    give(to, &required(suggestion, "suggestion"));
  });
}

psk_code psk_solve(psk_reconstructor* reconstructor, const psk_cloud* cloud, const psk_options* options,
                   psk_field** field, psk_error* error) {
  return guarded(error, [&] {
    run(reconstructor, [&](Reconstructor& r) {
      const Options all = options_of(options);
      required(field, "field") = new psk_field{r.solve(
          required(cloud, "cloud").cloud, static_cast<const SolveOptions&>(all), static_cast<const RunOptions&>(all))};
    });
  });
}

psk_code psk_solve_points(psk_reconstructor* reconstructor, const psk_points* points, const psk_options* options,
                          psk_field** field, psk_error* error) {
  return guarded(error, [&] {
    run(reconstructor, [&](Reconstructor& r) {
      const Options all = options_of(options);
      with_device_points(r.workspace(), points, [&](const DevicePoints& input) {
        required(field, "field") =
            new psk_field{r.solve(input, static_cast<const SolveOptions&>(all), static_cast<const RunOptions&>(all))};
      });
    });
  });
}

void psk_field_free(psk_field* field) { delete field; }

double psk_field_isovalue(const psk_field* field) { return field == nullptr ? 0 : field->field.isovalue(); }

void psk_field_cube(const psk_field* field, double lower[3], double* side) {
  if (field == nullptr) return;
  store(field->field.cube_lower_world(), lower);
  *side = field->field.cube_size_world();
}

psk_code psk_field_values(const psk_field* field, const psk_array* points, float* values, psk_error* error) {
  return guarded(error, [&] {
    const StridedArray array = strided(required(points, "points"));
    if (points->memory != PSK_HOST) throw Error(ErrorCode::usage, "the points must be on the host");
    const std::vector<Vec3d> places = vectors_of(array);
    const std::vector<float> found = required(field, "field").field.values(places);
    if (!found.empty()) std::copy(found.begin(), found.end(), &required(values, "values"));
  });
}

psk_code psk_field_extract(const psk_field* field, const psk_options* options, int32_t memory, psk_mesh** mesh,
                           psk_error* error) {
  return guarded(error, [&] {
    const Field& from = required(field, "field").field;
    const Options all = options_of(options);
    required(mesh, "mesh") =
        memory == PSK_DEVICE ? new_mesh(from.workspace(), from.extract_on_device(all)) : new_mesh(from.extract(all));
  });
}
