// pointskin check: is a mesh watertight, and does it run through itself?
#include <cstdint>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>
#include <pointskin/formats.hpp>
#include <pointskin/io.hpp>
#include <pointskin/scale.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "fit_args.hpp"
#include "json_text.hpp"
#include "run_memory.hpp"
#include "scene/vector_json.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArgs {
  std::string file;
  int threads = 0;
  std::int64_t max_memory_bytes = 0;
  bool json = false;
  bool self_intersections = false;
};

/// What the program finds out.
struct Findings {
  MeshReport mesh;
  std::optional<SelfIntersections> self_intersections;  ///< unset if nobody asked

  [[nodiscard]] bool good() const {
    return mesh.watertight() && (!self_intersections || self_intersections->pairs == 0);
  }
};

const char* kind_of(const IntersectingPair& pair) { return pair.touching ? "touching" : "crossing"; }

Json check_json(const SelfIntersections& found) {
  Json listed = Json::array();
  for (const IntersectingPair& pair : found.listed)
    listed.push_back({{"triangles", pair.triangles}, {"kind", kind_of(pair)}, {"place", pair.place_world}});
  return {{"pairs", found.pairs}, {"touching", found.touching}, {"triangles", found.triangles}, {"listed", listed}};
}

Json check_json(const CheckArgs& args, const Findings& findings) {
  const MeshReport& r = findings.mesh;
  Json json = {{"version", 1},
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
  if (findings.self_intersections) json["self_intersections"] = check_json(*findings.self_intersections);
  return json;
}

std::string human_text(const SelfIntersections& found) {
  if (found.pairs == 0) return "embedded    yes (no two triangles meet beside what they share)\n";
  std::string text = fmt::format("embedded    no ({} pairs of triangles meet, {} of them only touch; {} triangles)\n",
                                 found.pairs, found.touching, found.triangles);
  for (const IntersectingPair& pair : found.listed)
    text +=
        fmt::format("            {} and {} {} at {:.9g} {:.9g} {:.9g}\n", pair.triangles[0], pair.triangles[1],
                    pair.touching ? "touch" : "cross", pair.place_world[0], pair.place_world[1], pair.place_world[2]);
  if (found.pairs > static_cast<std::int64_t>(found.listed.size())) text += "            ...\n";
  return text +
         "            (a mesh of `reconstruct` crosses itself in single cells of three rare kinds only, and touches "
         "itself\n"
         "            where float32 is too coarse for its cells; an envelope and smoothing may fold it: docs/cli.md)\n";
}

std::string human_text(const CheckArgs& args, const Findings& findings) {
  const MeshReport& r = findings.mesh;
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
  text += fmt::format("area        {:.9g}\n", r.area);
  return findings.self_intersections ? text + human_text(*findings.self_intersections) : text;
}

/// What the numbers of the vertices tell, from a file that may be larger than memory.
MeshReport measure_within(const CheckArgs& args) {
  if (args.max_memory_bytes == 0) return measure_file(args.file, {.max_memory_bytes = 0, .threads = args.threads});
  const std::int64_t left = bytes_left_of(args.max_memory_bytes);
  try {
    return measure_file(args.file, {.max_memory_bytes = left, .threads = args.threads});
  } catch (const Error& error) {
    if (error.code() != ErrorCode::over_limit) throw;
    throw Error(ErrorCode::over_limit,
                fmt::format("--max-memory {}, of which the program takes {}: {}",
                            format_bytes(static_cast<double>(args.max_memory_bytes)),
                            format_bytes(static_cast<double>(args.max_memory_bytes - left)), error.what()));
  }
}

Findings find(const CheckArgs& args) {
  if (!args.self_intersections) return {measure_within(args), std::nullopt};
  const Mesh mesh = read_mesh(args.file, {.shift = std::nullopt, .threads = args.threads});
  if (mesh.triangles.empty()) return {};
  return {measure(mesh, args.threads), find_self_intersections(mesh, {.threads = args.threads})};
}

int run(const CheckArgs& args) {
  check_threads(args.threads);
  const Findings findings = find(args);
  if (findings.mesh.triangles == 0)
    throw Error(ErrorCode::invalid_input, args.file + ": has no triangles; name a mesh, not a cloud");
  write_stdout(args.json ? json_text(check_json(args, findings)) : human_text(args, findings));
  return findings.good() ? 0 : static_cast<int>(ErrorCode::empty_result);
}

constexpr char kCheckFooter[] =
    "Watertight means: every edge has two triangles, which run through it in opposite directions; every vertex has "
    "one\n"
    "fan; no triangle names a vertex twice; the enclosed volume is positive. Volume is in world units^3, area in "
    "world\n"
    "units^2. Exit code 0 only when watertight, 5 when not, 3 when the file cannot be read.\n\n"
    "--self-intersections: embedded means that no two triangles have a point in common beside the vertices and edges\n"
    "that they share by number. Exact, also for triangles that touch, lie in one plane or have no area. A mesh of\n"
    "`reconstruct` crosses itself in single cells of three rare kinds only; an envelope and smoothing may fold it.";

OptionTable check_options(CheckArgs& args) {
  return {
      {"Check",
       {option("MESH", "mesh: " + format_names(&FormatInfo::reads_meshes) + "; - reads PLY from stdin", &args.file, {},
               {.required = true}),
        option("--self-intersections",
               "also find pairs of triangles that meet beside what they share; 5 if there are any",
               &args.self_intersections)}},
      {"Output", {json_row(args.json)}},
      {"Limits",
       {option("--max-memory SIZE", "memory that the process may take, e.g. 1G; less than the mesh needs takes longer",
               memory_limit(args.max_memory_bytes), {}, {.excludes = "--self-intersections"}),
        threads_row(args.threads)}}};
}

}  // namespace

Command check_command() {
  return make_command({"check", "Tell whether a mesh is watertight: exit code 0, or 5 if not.", kCheckFooter},
                      check_options, run);
}

}  // namespace pointskin::cli
