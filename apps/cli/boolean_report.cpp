#include "boolean_report.hpp"

#include <fmt/format.h>

#include "console.hpp"
#include "report.hpp"
#include "summary_words.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

double fit_ms(const RunReport& run) { return run.octree_ms + run.splat_ms + run.solve_ms; }

Json part_json(const BooleanPart& part, bool is_mesh, std::int64_t dropped_on_reading) {
  return {{"kind", is_mesh ? "mesh" : "cloud"},
          {"points", part.points},
          {"invalid", dropped_on_reading},
          {"strays", part.strays},
          {"kept", part.kept},
          {"flipped", part.flipped},
          {"dropped", part.dropped},
          {"coincident", part.coincident},
          {"isovalue", part.fit.isovalue},
          {"nodes", part.fit.nodes}};
}

Json ms_json(const BooleanRecord& record) {
  const BooleanReport& run = record.run;
  return {{"read", record.read_ms},
          {"fit_a", fit_ms(run.a.fit)},
          {"fit_b", fit_ms(run.b.fit)},
          {"classify", run.classify_ms + run.gather_ms},
          {"crease", run.crease_ms + run.apart_ms},
          {"fit_result", fit_ms(run.result)},
          {"extract", run.result.extract_ms},
          {"download", run.result.download_ms},
          {"write", record.write_ms},
          {"total", record.total_ms}};
}

}  // namespace

Json to_json(const BooleanRecord& record) {
  const BooleanReport& run = record.run;
  Json json = {{"version", 1}, {"command", "boolean"}};
  json["device"] = to_json(record.device);
  json["op"] = record.op;
  json["files"] = record.files;
  json["options"] = record.shown_options;
  json["warnings"] = printed_warnings();
  json["a"] = part_json(run.a, record.a_is_mesh, record.a_dropped);
  json["b"] = part_json(run.b, record.b_is_mesh, record.b_dropped);
  json["added"] = run.added;
  json["curve_length"] = run.curve_length;
  json["result"] = {{"points", run.result.points}, {"isovalue", run.result.isovalue}, {"nodes", run.result.nodes}};
  json["mesh"] = to_json(record.mesh);
  json["mesh"]["volume"] = record.mesh.volume;
  json["ms"] = ms_json(record);
  json["memory"] = {{"host_peak_bytes", record.host_peak_bytes}, {"device_peak_bytes", run.device_peak_bytes}};
  return json;
}

std::string summary(const BooleanRecord& record) {
  const BooleanReport& run = record.run;
  const auto part = [](const char* name, const BooleanPart& p) {
    return fmt::format("{}: {} of {} points kept ({} flipped)", name, p.kept, p.points, p.flipped);
  };
  return fmt::format(
      "{}; {}; {} added along {:.4g} units of crease; depth {}, triangles {}, {}; ms: fits {:.1f}, classify {:.1f}, "
      "crease {:.1f}, total {:.1f}; {}",
      part("A", run.a), part("B", run.b), run.added, run.curve_length, run.result.depth, record.mesh.triangles,
      record.shape, fit_ms(run.a.fit) + fit_ms(run.b.fit) + fit_ms(run.result), run.classify_ms, run.crease_ms,
      record.total_ms, memory_words(record.device, run.device_peak_bytes, record.host_peak_bytes));
}

}  // namespace pointskin::cli
