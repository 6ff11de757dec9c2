#include "report.hpp"

#include <fmt/format.h>

#include "console.hpp"
#include "normal_args.hpp"
#include "scene/vector_json.hpp"
#include "statistics.hpp"
#include "summary_words.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Points that were used.
std::int64_t used(const Record& record) { return record.points - record.dropped - record.run.strays; }

Json input_json(const Record& record) {
  Json json = {{"points", record.points}, {"used", used(record)}, {"dropped", record.dropped}};
  json["normals"] = name_of(record.run.normals_done);
  json["strays"] = {{"count", record.run.strays}, {"points", record.run.farthest_strays}};
  return json;
}

Json octree_json(const RunReport& run) {
  Json levels = Json::array();
  for (const LevelReport& level : run.levels) levels.push_back({{"depth", level.depth}, {"nodes", level.nodes}});
  return {{"depth", run.depth}, {"nodes", run.nodes}, {"levels", levels}};
}

Json solve_json(const Record& record) {
  Json levels = Json::array();
  for (const LevelReport& level : record.run.levels) {
    levels.push_back({{"depth", level.depth},
                      {"unknowns", level.unknowns},
                      {"iterations", level.iterations},
                      {"residual_before", level.residual_before},
                      {"residual_after", level.residual_after}});
  }
  return {{"fits", record.run.fits}, {"levels", levels}};
}

Json trim_json(const TrimReport& trim) {
  return {{"quantile", trim.quantile},
          {"density", trim.density},
          {"area_before", trim.area_before},
          {"area_removed", trim.area_removed},
          {"triangles_before", trim.triangles_before},
          {"triangles_removed", trim.triangles_removed},
          {"triangles_split", trim.triangles_split},
          {"islands_removed", trim.islands_removed},
          {"holes_filled", trim.holes_filled}};
}

Json envelope_json(const Record& record) {
  const EnvelopeReport& envelope = record.run.envelope;
  return {{"file", record.shown_options.at("envelope")},
          {"samples_outside", envelope.samples_outside},
          {"vertices_moved", envelope.vertices_moved},
          {"farthest_move", envelope.farthest_move}};
}

Json offset_json(const Record& record) {
  const OffsetReport& offset = record.run.offset;
  return {{"distance", record.options.offset}, {"cells", offset.cells},           {"cube_growth", offset.cube_growth},
          {"triangles", offset.triangles},     {"band_cells", offset.band_cells}, {"ms", offset.ms}};
}

Json pieces_json(const PiecesReport& pieces) {
  return {{"pieces", pieces.pieces},
          {"pieces_removed", pieces.pieces_removed},
          {"triangles_removed", pieces.triangles_removed}};
}

/// @param pictures  of the views; empty: there are none
Json views_json(const std::vector<ProblemView>& views, const PictureNames& pictures) {
  Json list = Json::array();
  for (std::size_t v = 0; v < views.size(); ++v)
    list.push_back({{"azimuth", views[v].azimuth_degrees},
                    {"elevation", views[v].elevation_degrees},
                    {"target", views[v].target_world},
                    {"zoom", views[v].zoom},
                    {"visible", views[v].visible},
                    {"matrix", views[v].matrix},
                    {"picture", v < pictures.size() ? Json(pictures[v]) : Json(nullptr)}});
  return list;
}

Json problems_json(const Record& record) {
  Json list = Json::array();
  for (std::size_t r = 0; r < record.problems.size(); ++r) {
    const ProblemRegion& region = record.problems[r];
    const Json views = views_json(region.views, r < record.pictures.size() ? record.pictures[r] : PictureNames());
    list.push_back({{"score", region.score},
                    {"peak", region.peak},
                    {"area", region.area},
                    {"triangles", region.triangles},
                    {"centroid", region.centroid_world},
                    {"lower", region.lower_world},
                    {"upper", region.upper_world},
                    {"mean_normal", region.mean_normal},
                    {"views", views}});
  }
  return list;
}

Json ms_json(const Record& record) {
  const RunReport& run = record.run;
  return {{"read", record.read_ms},      {"upload", run.upload_ms},  {"octree", run.octree_ms},
          {"splat", run.splat_ms},       {"solve", run.solve_ms},    {"extract", run.extract_ms},
          {"download", run.download_ms}, {"write", record.write_ms}, {"total", record.total_ms}};
}

Json repeat_json(const std::vector<double>& values) {
  const Spread ms = spread_of(values);
  return {{"min", ms.min}, {"median", ms.median}, {"max", ms.max}};
}

}  // namespace

Json to_json(const Device& device) {
  return {{"kind", device.kind == DeviceKind::cuda ? "cuda" : "cpu"}, {"name", device.name()}};
}

Json to_json(const MeshReport& mesh) {
  return {{"vertices", mesh.vertices},   {"triangles", mesh.triangles},   {"closed", mesh.closed()},
          {"manifold", mesh.manifold()}, {"components", mesh.components}, {"euler", mesh.euler}};
}

Json or_null(const std::string& file) { return file.empty() ? Json(nullptr) : Json(file); }

Json to_json(const Record& record) {
  Json json = {{"version", 1}, {"command", record.command}};
  json["device"] = to_json(record.device);
  json["input"] = input_json(record);
  json["options"] = record.shown_options;
  json["warnings"] = printed_warnings();
  if (record.run.normals) json["normals"] = to_json(*record.run.normals);
  json["octree"] = octree_json(record.run);
  json["solve"] = solve_json(record);
  json["isovalue"] = record.run.isovalue;
  if (record.options.envelope != nullptr) json["envelope"] = envelope_json(record);
  if (record.options.offset != 0) json["offset"] = offset_json(record);
  if (record.options.trim != 0) json["trim"] = trim_json(record.run.trim);
  if (record.options.largest || record.options.min_component > 0) json["pieces"] = pieces_json(record.run.pieces);
  if (record.options.weakness) json["problems"] = problems_json(record);
  json["mesh"] = to_json(record.mesh);
  json["ms"] = ms_json(record);
  if (!record.repeat_ms.empty()) json["ms_repeat"] = repeat_json(record.repeat_ms);
  if (record.blocks > 0) json["blocks"] = {{"count", record.blocks}, {"coarse_level", record.coarse_level}};
  json["memory"] = {{"host_peak_bytes", record.host_peak_bytes}, {"device_peak_bytes", record.run.device_peak_bytes}};
  return json;
}

std::string summary(const Record& record) {
  const RunReport& run = record.run;
  const double function_ms = run.splat_ms + run.solve_ms;
  std::string line = fmt::format(
      "points {}, depth {}, triangles {}, {}; ms: octree {:.1f}, function {:.1f}, surface {:.1f}, total {:.1f}; {}",
      used(record), run.depth, record.mesh.triangles, record.shape, run.octree_ms, function_ms, run.extract_ms,
      record.total_ms, memory_words(record.device, run.device_peak_bytes, record.host_peak_bytes));
  if (record.options.trim != 0 && run.trim.quantile == 0) line += "; nothing to trim: the surface is near the points";
  if (run.trim.quantile > 0) {
    const double share = run.trim.area_before > 0 ? run.trim.area_removed / run.trim.area_before : 0;
    line += fmt::format("; trimmed {:.1f} % of the area, below {:.4g} points per unit^2 (--trim {:g})", 100 * share,
                        run.trim.density, run.trim.quantile);
  }
  if (!record.repeat_ms.empty()) {
    const double ms = spread_of(record.repeat_ms).median;
    line +=
        fmt::format("; {} runs: median {:.2f} ms, {:.1f} frames per second", record.repeat_ms.size(), ms, 1000 / ms);
  }
  return line;
}

std::string problem_table(const std::vector<ProblemRegion>& problems) {
  if (problems.empty()) return "no region whose topology is doubtful";
  std::string table = "rank       score    peak        area  azimuth  elevation    zoom  target";
  int rank = 0;
  for (const ProblemRegion& region : problems) {
    const ProblemView& view = region.views.front();
    const Vec3d& at = view.target_world;
    table += fmt::format("\n{:4}{:12.4g}{:8.3f}{:12.4g}{:9.1f}{:11.1f}{:8.2f}  {:.6g},{:.6g},{:.6g}", ++rank,
                         region.score, region.peak, region.area, view.azimuth_degrees, view.elevation_degrees,
                         view.zoom, at[0], at[1], at[2]);
  }
  return table;
}

std::string level_table(const Record& record) {
  std::string table = fmt::format("device {}, isovalue {:.6f}\n", record.device.name(), record.run.isovalue);
  table += "depth       nodes    unknowns  iterations  residual before   after";
  for (const LevelReport& level : record.run.levels) {
    table += fmt::format("\n{:5}{:12}{:12}{:12}{:17.3e}{:12.3e}", level.depth, level.nodes, level.unknowns,
                         level.iterations, level.residual_before, level.residual_after);
  }
  return table;
}

}  // namespace pointskin::cli
