// pointskin check: is a mesh watertight?
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "json_text.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArgs {
  std::string file;
  int threads = 0;
  bool json = false;
};

Json to_json(const CheckArgs& args, const MeshReport& r) {
  return {{"version", 1},
          {"command", "check"},
          {"file", args.file},
          {"watertight", r.watertight()},
          {"closed", r.closed()},
          {"manifold", r.manifold()},
          {"oriented", r.oriented()},
          {"euler", r.euler},
          {"components", r.components},
          {"volume", r.volume},
          {"area", r.area},
          {"vertices", r.vertices},
          {"used_vertices", r.used_vertices},
          {"triangles", r.triangles},
          {"edges", r.edges},
          {"boundary_edges", r.boundary_edges},
          {"non_manifold_edges", r.non_manifold_edges},
          {"misoriented_edges", r.misoriented_edges},
          {"non_manifold_vertices", r.non_manifold_vertices},
          {"degenerate_triangles", r.degenerate_triangles}};
}

std::string human_text(const CheckArgs& args, const MeshReport& r) {
  const auto yes_no = [](bool value) { return value ? "yes" : "no"; };
  std::string text = fmt::format("file        {}\n", args.file);
  text += fmt::format("watertight  {}\n", yes_no(r.watertight()));
  text += fmt::format("closed      {} ({} boundary edges)\n", yes_no(r.closed()), r.boundary_edges);
  text += fmt::format("manifold    {} ({} edges, {} vertices not; {} degenerate triangles)\n", yes_no(r.manifold()),
                      r.non_manifold_edges, r.non_manifold_vertices, r.degenerate_triangles);
  text += fmt::format("oriented    {} ({} edges not)\n", yes_no(r.oriented()), r.misoriented_edges);
  text += fmt::format("euler       {} ({} vertices, {} edges, {} triangles)\n", r.euler, r.used_vertices, r.edges,
                      r.triangles);
  text += fmt::format("components  {}\n", r.components);
  text += fmt::format("volume      {:.9g}\n", r.volume);
  return text + fmt::format("area        {:.9g}\n", r.area);
}

int run(const CheckArgs& args) {
  check_threads(args.threads);
  const Mesh mesh = read_mesh(args.file, {.shift = std::nullopt, .threads = args.threads});
  if (mesh.triangles.empty())
    throw Error(ErrorCode::invalid_input, args.file + ": has no triangles; name a mesh, not a cloud");
  const MeshReport report = measure(mesh, args.threads);
  write_stdout(args.json ? json_text(to_json(args, report)) : human_text(args, report));
  return report.watertight() ? 0 : static_cast<int>(ErrorCode::empty_result);
}

constexpr char kFooter[] =
    "Watertight means: every edge has two triangles, which run through it in opposite directions; every vertex has "
    "one\n"
    "fan; no triangle names a vertex twice; the enclosed volume is positive. Volume is in world units^3, area in "
    "world\n"
    "units^2. Exit code 0 only when watertight, 5 when not, 3 when the file cannot be read.";

}  // namespace

void add_check(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "check", "Tell whether a mesh is watertight: exit code 0, or 5 if not.");
  auto args = std::make_shared<CheckArgs>();
  command->footer(kFooter);
  command->add_option("MESH", args->file, "mesh: PLY, OBJ, STL or OFF; - reads PLY from stdin")->required();
  command->add_flag("--json", args->json, "print JSON")->group("Output");
  add_threads_option(*command, args->threads, "Limits");
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
