// Operations of documents as JSON, read. docs/cli.md, "edit", describes them.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "scene/camera_json.hpp"
#include "scene/deform_script.hpp"
#include "scene/document.hpp"
#include "scene/options.hpp"
#include "scene/source_json.hpp"
#include "shapes.hpp"

namespace pointskin::scene {
namespace {

namespace fs = std::filesystem;

/// What reading needs besides the JSON.
struct Context {
  fs::path folder;
  CameraOfPicture camera_of_picture;
  Sources* sources;  ///< null: files and shapes are not read
};

Guide guide_at(const JsonReader& json, const Context& context) {
  json.object({"op", "camera", "stroke", "area", "rectangle", "interval", "normals", "inside_only"});
  Guide guide;
  guide.camera = read_camera(json.at("camera"), context.camera_of_picture);
  if (json.has("stroke")) guide.stroke = read_pixels(json.at("stroke"));
  guide.area = read_area(json);
  if (json.has("interval")) guide.interval = json.at("interval").number();
  if (json.has("inside_only")) guide.inside_only = json.at("inside_only").boolean();
  if (json.has("normals") && json.at("normals").one_of({"cloud", "stroke"}) == "stroke")
    guide.normals = GuideNormals::stroke;
  return guide;
}

/// "layers": all points that the view shows in the area, or those in front.
bool front_layer_at(const JsonReader& json) {
  return json.has("layers") && json.at("layers").one_of({"through", "front"}) == "front";
}

Remove remove_at(const JsonReader& json, const Context& context) {
  json.object({"op", "camera", "area", "rectangle", "originals", "layers"});
  Remove remove;
  remove.camera = read_camera(json.at("camera"), context.camera_of_picture);
  remove.area = read_area(json);
  remove.front_layer = front_layer_at(json);
  if (json.has("originals")) remove.originals = json.at("originals").boolean();
  return remove;
}

Flip flip_at(const JsonReader& json, const Context& context) {
  json.object({"op", "camera", "area", "rectangle", "layers"});
  return {read_camera(json.at("camera"), context.camera_of_picture), read_area(json), front_layer_at(json)};
}

/// {"lower": [x, y, z], "upper": [x, y, z]}, either may be left out.
void read_box(const JsonReader& json, Insert& insert) {
  json.object({"lower", "upper"});
  const auto read = [&json](const char* key, Vec3d& corner) {
    if (json.has(key)) corner = json.at(key).vector();
  };
  read("lower", insert.lower);
  read("upper", insert.upper);
}

/// A view of the part, and what is to be copied of it. Pictures show the present surface and not the part, so that only
/// matrices will do.
void read_view(const JsonReader& json, Insert& insert) {
  insert.area = read_area(json);
  if (insert.area.empty() && !json.has("camera")) return;
  if (insert.area.empty()) json.refuse("has a camera, but no area");
  const JsonReader camera = json.at("camera");
  insert.camera = read_camera(camera, [&camera](const RenderOptions&) -> Camera {
    camera.refuse("must have view and projection: it looks at the part");
  });
}

Insert insert_at(const JsonReader& json, const Context& context) {
  json.object({"op", "file", "shape", "points", "box", "camera", "area", "rectangle", "scale", "rotation",
               "translation", "snap"});
  Insert insert;
  read_view(json, insert);
  const SolidSource source = read_source(json, context.folder);
  if (json.has("box")) read_box(json.at("box"), insert);
  insert.placement = read_placement(json);
  if (json.has("snap")) insert.snap = json.at("snap").boolean();
  insert.source = source_text(source);
  if (context.sources != nullptr) insert.part = context.sources->part(source);
  return insert;
}

Deform deform_at(const JsonReader& json) {
  json.object({"op", "handles", "lattices"});
  return {read_deformation(json)};
}

Combine combine_at(const JsonReader& json, const Context& context) {
  json.object({"op", "operation", "with", "scale", "rotation", "translation", "creases", "coincidence"});
  Combine combine;
  const std::string word = json.at("operation").one_of({"union", "intersection", "difference", "symmetric"});
  combine.op = word == "union"          ? BooleanOp::unite
               : word == "intersection" ? BooleanOp::intersect
               : word == "difference"   ? BooleanOp::subtract
                                        : BooleanOp::symmetric_difference;
  const JsonReader with = json.at("with");
  with.object({"file", "shape", "points"});
  combine.with = read_source(with, context.folder);
  combine.placement = read_placement(json);
  if (!(combine.placement.scale > 0)) json.at("scale").refuse("must be above 0");
  if (json.has("creases") && json.at("creases").one_of({"sampled", "none"}) == "none") combine.creases = Creases::none;
  if (json.has("coincidence")) combine.coincidence_cells = json.at("coincidence").number();
  if (context.sources != nullptr) combine.solid = context.sources->solid(combine.with);
  return combine;
}

NormalMethod method_of(const std::string& word) {
  if (word == "sensor") return NormalMethod::sensor;
  if (word == "propagate") return NormalMethod::propagate;
  if (word == "iterate") return NormalMethod::iterate;
  return word == "repair" ? NormalMethod::repair : NormalMethod::automatic;
}

void read_normal_options(const JsonReader& json, NormalOptions& options) {
  constexpr std::int64_t kMostSeed = std::int64_t{1} << 53;
  if (json.has("sensors")) {
    const JsonReader sensors = json.at("sensors");
    sensors.array();
    for (std::size_t i = 0; i < sensors.size(); ++i) options.sensors.push_back(sensors.at(i).vector());
  }
  if (json.has("random_start")) options.random_start = json.at("random_start").boolean();
  if (json.has("seed")) options.seed = static_cast<std::uint64_t>(json.at("seed").whole_number(0, kMostSeed));
  if (json.has("max_rounds")) options.max_rounds = static_cast<int>(json.at("max_rounds").whole_number(1, 1000));
  if (json.has("keep_within_degrees")) options.keep_within_degrees = json.at("keep_within_degrees").number();
  if (json.has("confidence")) options.confidence = json.at("confidence").boolean();
  if (json.has("curvature")) options.curvature = json.at("curvature").boolean();
  try {
    validate(options);
  } catch (const Error& error) {
    json.refuse(error.what());
  }
}

Orient orient_at(const JsonReader& json) {
  json.object({"op", "method", "sensors", "random_start", "seed", "max_rounds", "keep_within_degrees", "confidence",
               "curvature"});
  Orient orient;
  const std::string word = json.at("method").one_of({"estimate", "sensor", "propagate", "iterate", "repair", "turn"});
  if (word == "turn") {
    json.object({"op", "method"});
    orient.what = Orient::What::turn;
    return orient;
  }
  if (word == "repair") orient.what = Orient::What::repair;
  orient.options.method = method_of(word);
  read_normal_options(json, orient.options);
  return orient;
}

Configure configure_at(const JsonReader& json) {
  (void)read_options(json, {});
  Configure configure{json.value()};
  configure.options.erase("op");
  if (configure.options.empty()) json.refuse("names no option");
  return configure;
}

SceneOperation read_operation(const JsonReader& json, const Context& context) {
  if (!json.value().is_object()) json.refuse("must be an object { }");
  const std::string op = json.at("op").one_of(
      {"guide", "remove", "flip", "insert", "deform", "boolean", "orient", "options", "undo", "redo"});
  if (op == "guide") return guide_at(json, context);
  if (op == "remove") return remove_at(json, context);
  if (op == "flip") return flip_at(json, context);
  if (op == "insert") return insert_at(json, context);
  if (op == "deform") return deform_at(json);
  if (op == "boolean") return combine_at(json, context);
  if (op == "orient") return orient_at(json);
  if (op == "options") return configure_at(json);
  json.refuse("is no operation, but an entry of a script");
}

}  // namespace

SolidSource read_source(const JsonReader& json, const fs::path& folder) {
  SolidSource source;
  if (json.has("file") == json.has("shape")) json.refuse("needs one of the keys 'file' and 'shape'");
  if (json.has("file")) {
    if (json.has("points")) json.refuse("must not have points: they are those of the file");
    const std::string file = json.at("file").text();
    if (file.empty()) json.at("file").refuse("must name a file");
    source.file = fs::absolute(folder / file).lexically_normal().string();
    return source;
  }
  source.shape = json.at("shape").text();
  const auto is_it = [&source](const char* name) { return source.shape == name; };
  if (std::none_of(bench::kShapeNames.begin(), bench::kShapeNames.end(), is_it))
    json.at("shape").refuse(fmt::format("must be one of {}", fmt::join(bench::kShapeNames, ", ")));
  if (json.has("points")) source.points = json.at("points").whole_number(1, kMostShapePoints);
  return source;
}

bool is_undo(const nlohmann::json& json) { return json.contains("op") && json["op"] == "undo"; }
bool is_redo(const nlohmann::json& json) { return json.contains("op") && json["op"] == "redo"; }

void check_operation(const nlohmann::json& json, const std::string& name) {
  const JsonReader reader(json, name);
  if (is_undo(json) || is_redo(json)) return reader.object({"op"});
  (void)read_operation(reader, {{}, [](const RenderOptions&) { return Camera(); }, nullptr});
}

SceneOperation operation_of(const nlohmann::json& json, const std::string& name, const fs::path& folder,
                            const CameraOfPicture& camera_of_picture, Sources* sources) {
  Sources own;
  return read_operation(JsonReader(json, name), {folder, camera_of_picture, sources != nullptr ? sources : &own});
}

std::vector<std::string> files_of(const nlohmann::json& json, const fs::path& folder) {
  std::vector<std::string> files;
  const auto add = [&](const nlohmann::json& holder) {
    if (holder.contains("file"))
      files.push_back(fs::absolute(folder / holder["file"].get<std::string>()).lexically_normal().string());
  };
  add(json);
  if (json.contains("with")) add(json["with"]);
  return files;
}

}  // namespace pointskin::scene
