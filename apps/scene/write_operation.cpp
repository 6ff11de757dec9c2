// Operations as JSON, written: read again, they are the same to the last bit.
#include <cmath>
#include <filesystem>
#include <system_error>

#include "scene/camera_json.hpp"
#include "scene/deform_script.hpp"
#include "scene/document.hpp"
#include "scene/source_json.hpp"
#include "scene/vector_json.hpp"

namespace pointskin::scene {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const char* layers_word(bool front_layer) { return front_layer ? "front" : "through"; }

/// Numbers that are not finite are not written: JSON has none.
Json box_json(const Insert& insert) {
  const auto is_finite = [](const Vec3d& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  Json box = Json::object();
  if (is_finite(insert.lower)) box["lower"] = insert.lower;
  if (is_finite(insert.upper)) box["upper"] = insert.upper;
  return box;
}

const char* word_of(BooleanOp op) {
  switch (op) {
    case BooleanOp::unite:
      return "union";
    case BooleanOp::intersect:
      return "intersection";
    case BooleanOp::subtract:
      return "difference";
    default:
      return "symmetric";
  }
}

struct Writer {
  const fs::path& folder;

  Json operator()(const Guide& guide) const {
    Json json = {{"op", "guide"}, {"camera", camera_json(guide.camera)}};
    if (!guide.stroke.empty()) json["stroke"] = guide.stroke;
    if (guide.stroke.empty()) json["area"] = guide.area;
    json["interval"] = guide.interval;
    json["normals"] = guide.normals == GuideNormals::stroke ? "stroke" : "cloud";
    json["inside_only"] = guide.inside_only;
    return json;
  }

  Json operator()(const Remove& remove) const {
    return {{"op", "remove"},
            {"camera", camera_json(remove.camera)},
            {"area", remove.area},
            {"originals", remove.originals},
            {"layers", layers_word(remove.front_layer)}};
  }

  Json operator()(const Flip& flip) const {
    return {{"op", "flip"},
            {"camera", camera_json(flip.camera)},
            {"area", flip.area},
            {"layers", layers_word(flip.front_layer)}};
  }

  Json operator()(const Insert& insert) const {
    Json json = {{"op", "insert"}};
    write_source(source_of_text(insert.source), folder, json);
    json["box"] = box_json(insert);
    if (!insert.area.empty()) {
      json["camera"] = camera_json(insert.camera);
      json["area"] = insert.area;
    }
    write_placement(insert.placement, json);
    json["snap"] = insert.snap;
    return json;
  }

  Json operator()(const Deform& deform) const {
    Json json = {{"op", "deform"}};
    write_deformation(deform.deformation, json);
    return json;
  }

  Json operator()(const Combine& combine) const {
    Json json = {{"op", "boolean"}, {"operation", word_of(combine.op)}, {"with", Json::object()}};
    write_source(combine.with, folder, json["with"]);
    write_placement(combine.placement, json);
    json["creases"] = combine.creases == Creases::none ? "none" : "sampled";
    json["coincidence"] = combine.coincidence_cells;
    return json;
  }

  Json operator()(const Orient& orient) const {
    if (orient.what == Orient::What::turn) return {{"op", "orient"}, {"method", "turn"}};
    const NormalOptions& options = orient.options;
    const bool automatic = options.method == NormalMethod::automatic;
    const char* const estimate = automatic ? "estimate" : pointskin::name_of(options.method);
    return {{"op", "orient"},
            {"method", orient.what == Orient::What::repair ? "repair" : estimate},
            {"sensors", options.sensors},
            {"random_start", options.random_start},
            {"seed", options.seed},
            {"max_rounds", options.max_rounds},
            {"keep_within_degrees", options.keep_within_degrees},
            {"confidence", options.confidence},
            {"curvature", options.curvature}};
  }

  Json operator()(const Configure& configure) const {
    Json json = {{"op", "options"}};
    for (const auto& [key, value] : configure.options.items()) json[key] = value;
    return json;
  }
};

constexpr char kShapePrefix[] = "shape:";

}  // namespace

std::string file_seen_from(const std::string& file, const fs::path& folder) {
  if (folder.empty()) return file;
  std::error_code failed;  // the way to it cannot be followed, for example because a name is too long
  const fs::path way = fs::proximate(file, folder, failed);
  return failed ? file : way.string();
}

void write_source(const SolidSource& source, const fs::path& folder, Json& json) {
  if (!source.file.empty()) {
    json["file"] = file_seen_from(source.file, folder);
    return;
  }
  json["shape"] = source.shape;
  json["points"] = source.points;
}

std::string source_text(const SolidSource& source) {
  if (!source.file.empty()) return source.file;
  return kShapePrefix + source.shape + ":" + std::to_string(source.points);
}

SolidSource source_of_text(const std::string& text) {
  SolidSource source;
  const std::size_t begin = std::size(kShapePrefix) - 1;
  const std::size_t colon = text.rfind(':');
  if (!text.starts_with(kShapePrefix) || colon < begin) {
    source.file = text;
    return source;
  }
  source.shape = text.substr(begin, colon - begin);
  source.points = std::stoll(text.substr(colon + 1));
  return source;
}

Json to_json(const SceneOperation& operation, const fs::path& folder) { return std::visit(Writer{folder}, operation); }

}  // namespace pointskin::scene
