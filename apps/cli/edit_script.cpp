#include "edit_script.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <pointskin/io.hpp>

#include "scene/json_reader.hpp"
#include "render_args.hpp"
#include "scene/vector_json.hpp"

namespace pointskin::cli {
namespace {

using scene::JsonReader;
using scene::parse_json;
using scene::read_text;

using Json = nlohmann::ordered_json;
using CameraOfPicture = std::function<Camera(const RenderOptions&)>;

constexpr int kVersion = 1;

Matrix4 matrix_at(const JsonReader& json) {
  Matrix4 matrix{};
  const std::vector<double> numbers = json.numbers(matrix.size());
  std::copy(numbers.begin(), numbers.end(), matrix.begin());
  return matrix;
}

int pixels_at(const JsonReader& json, const char* key, int otherwise) {
  constexpr int kMost = 16384;
  return json.has(key) ? static_cast<int>(json.at(key).whole_number(1, kMost)) : otherwise;
}

UpAxis up_at(const JsonReader& json) {
  return parse_up(json.one_of({"x", "y", "z", "-x", "-y", "-z", "+x", "+y", "+z"}), "up");
}

/// As the options of `pointskin render`.
RenderOptions picture_at(const JsonReader& json) {
  json.object({"azimuth", "elevation", "up", "orthographic", "width", "height", "target", "fit", "zoom", "fov"});
  RenderOptions options;
  options.fit = Fit::sphere;  // as before there was another
  if (json.has("fit") && json.at("fit").one_of({"sphere", "box"}) == "box") options.fit = Fit::box;
  if (json.has("target")) options.target_world = json.at("target").vector();
  if (json.has("zoom")) options.zoom = json.at("zoom").number();
  if (json.has("fov")) options.field_of_view_degrees = json.at("fov").number();
  options.width = pixels_at(json, "width", options.width);
  options.height = pixels_at(json, "height", options.height);
  if (json.has("azimuth")) options.azimuth_degrees = json.at("azimuth").number();
  if (json.has("elevation")) options.elevation_degrees = json.at("elevation").number();
  if (json.has("orthographic") && json.at("orthographic").boolean()) options.projection = Projection::orthographic;
  if (json.has("up")) options.up = up_at(json.at("up"));
  return options;
}

Camera camera_at(const JsonReader& json, const CameraOfPicture& camera_of_picture) {
  if (!json.has("view")) return camera_of_picture(picture_at(json));
  json.object({"view", "projection", "width", "height"});
  Camera camera;
  camera.view = matrix_at(json.at("view"));
  camera.projection = matrix_at(json.at("projection"));
  camera.width = json.at("width").number();
  camera.height = json.at("height").number();
  return camera;
}

std::vector<Pixel> pixels_at(const JsonReader& json) {
  std::vector<Pixel> pixels;
  json.array();
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::vector<double> xy = json.at(i).numbers(2);
    pixels.push_back({xy[0], xy[1]});
  }
  return pixels;
}

/// "area": polygons, or "rectangle": two opposite corners.
Area area_at(const JsonReader& json) {
  Area area;
  if (json.has("rectangle")) {
    const std::vector<double> r = json.at("rectangle").numbers(4);
    area.push_back({{r[0], r[1]}, {r[2], r[1]}, {r[2], r[3]}, {r[0], r[3]}});
  } else if (json.has("area")) {
    const JsonReader polygons = json.at("area");
    polygons.array();
    for (std::size_t i = 0; i < polygons.size(); ++i) area.push_back(pixels_at(polygons.at(i)));
  }
  return area;
}

Guide guide_at(const JsonReader& json, const CameraOfPicture& camera_of_picture) {
  json.object({"op", "camera", "stroke", "area", "rectangle", "interval", "normals", "inside_only"});
  Guide guide;
  guide.camera = camera_at(json.at("camera"), camera_of_picture);
  if (json.has("stroke")) guide.stroke = pixels_at(json.at("stroke"));
  guide.area = area_at(json);
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

Remove remove_at(const JsonReader& json, const CameraOfPicture& camera_of_picture) {
  json.object({"op", "camera", "area", "rectangle", "originals", "layers"});
  Remove remove;
  remove.camera = camera_at(json.at("camera"), camera_of_picture);
  remove.area = area_at(json);
  remove.front_layer = front_layer_at(json);
  if (json.has("originals")) remove.originals = json.at("originals").boolean();
  return remove;
}

Flip flip_at(const JsonReader& json, const CameraOfPicture& camera_of_picture) {
  json.object({"op", "camera", "area", "rectangle", "layers"});
  return {camera_at(json.at("camera"), camera_of_picture), area_at(json), front_layer_at(json)};
}

/// "rotation": nine numbers, or {"axis": [x, y, z], "degrees": a}.
std::array<double, 9> rotation_at(const JsonReader& json) {
  std::array<double, 9> matrix{};
  if (json.is_array()) {
    const std::vector<double> numbers = json.numbers(9);
    std::copy(numbers.begin(), numbers.end(), matrix.begin());
    return matrix;
  }
  json.object({"axis", "degrees"});
  Vec3d axis = json.at("axis").vector();
  const double length = std::hypot(axis[0], axis[1], axis[2]);
  if (!(length > 0)) json.at("axis").refuse("must not be zero");
  axis = axis / length;
  const double angle = json.at("degrees").number() * std::numbers::pi / 180;
  const double s = std::sin(angle);
  const double c = 1 - std::cos(angle);
  const double x = axis[0];
  const double y = axis[1];
  const double z = axis[2];
  return {1 - c * (y * y + z * z), c * x * y - s * z,       c * x * z + s * y,
          c * x * y + s * z,       1 - c * (x * x + z * z), c * y * z - s * x,
          c * x * z - s * y,       c * y * z + s * x,       1 - c * (x * x + y * y)};
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

/// The file that an insertion names, seen from the script's folder.
std::string source_at(const JsonReader& json, const std::filesystem::path& folder) {
  return std::filesystem::absolute(folder / json.at("file").text()).lexically_normal().string();
}

/// A view of the part, and what is to be copied of it. Pictures show the present surface and not the part, so that only
/// matrices will do.
void read_view(const JsonReader& json, Insert& insert) {
  insert.area = area_at(json);
  if (insert.area.empty() && !json.has("camera")) return;
  if (insert.area.empty()) json.refuse("has a camera, but no area");
  const JsonReader camera = json.at("camera");
  insert.camera = camera_at(camera, [&camera](const RenderOptions&) -> Camera {
    camera.refuse("must have view and projection: it looks at the part");
  });
}

Insert insert_at(const JsonReader& json, const std::filesystem::path& folder) {
  json.object({"op", "file", "box", "camera", "area", "rectangle", "scale", "rotation", "translation", "snap"});
  Insert insert;
  read_view(json, insert);
  insert.source = source_at(json, folder);
  insert.part = std::make_shared<const Cloud>(read_cloud(insert.source));
  if (json.has("box")) read_box(json.at("box"), insert);
  if (json.has("scale")) insert.placement.scale = json.at("scale").number();
  if (json.has("rotation")) insert.placement.rotation = rotation_at(json.at("rotation"));
  if (json.has("translation")) insert.placement.translation = json.at("translation").vector();
  if (json.has("snap")) insert.snap = json.at("snap").boolean();
  return insert;
}

Json to_json(const Camera& camera) {
  return {{"view", camera.view}, {"projection", camera.projection}, {"width", camera.width}, {"height", camera.height}};
}

Json to_json(const Guide& guide, const std::filesystem::path& /*folder*/) {
  Json json = {{"op", "guide"}, {"camera", to_json(guide.camera)}};
  if (!guide.stroke.empty()) json["stroke"] = guide.stroke;
  if (guide.stroke.empty()) json["area"] = guide.area;
  json["interval"] = guide.interval;
  json["normals"] = guide.normals == GuideNormals::stroke ? "stroke" : "cloud";
  json["inside_only"] = guide.inside_only;
  return json;
}

const char* layers_json(bool front_layer) { return front_layer ? "front" : "through"; }

Json to_json(const Remove& remove, const std::filesystem::path& /*folder*/) {
  return {{"op", "remove"},
          {"camera", to_json(remove.camera)},
          {"area", remove.area},
          {"originals", remove.originals},
          {"layers", layers_json(remove.front_layer)}};
}

Json to_json(const Flip& flip, const std::filesystem::path& /*folder*/) {
  return {
      {"op", "flip"}, {"camera", to_json(flip.camera)}, {"area", flip.area}, {"layers", layers_json(flip.front_layer)}};
}

/// Numbers that are not finite are not written: JSON has none.
Json box_json(const Insert& insert) {
  const auto is_finite = [](const Vec3d& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  Json box = Json::object();
  if (is_finite(insert.lower)) box["lower"] = insert.lower;
  if (is_finite(insert.upper)) box["upper"] = insert.upper;
  return box;
}

Json to_json(const Insert& insert, const std::filesystem::path& folder) {
  Json json = {{"op", "insert"}, {"file", std::filesystem::proximate(insert.source, folder).string()}};
  json["box"] = box_json(insert);
  if (!insert.area.empty()) {
    json["camera"] = to_json(insert.camera);
    json["area"] = insert.area;
  }
  json["scale"] = insert.placement.scale;
  json["rotation"] = insert.placement.rotation;
  json["translation"] = insert.placement.translation;
  json["snap"] = insert.snap;
  return json;
}

std::filesystem::path folder_of(const std::string& script) { return std::filesystem::path(script).parent_path(); }

std::string op_of(const JsonReader& entry) {
  return entry.at("op").one_of({"guide", "remove", "insert", "flip", "undo", "redo"});
}

JsonReader operations_of(const nlohmann::json& json, const std::string& path) {
  const JsonReader script(json, path);
  script.object({"version", "operations"});
  (void)script.at("version").whole_number(kVersion, kVersion);
  const JsonReader operations = script.at("operations");
  operations.array();
  return operations;
}

}  // namespace

EditScript::EditScript(const std::string& path) : path_(path), json_(parse_json(read_text(path), path)) {
  // Everything but pictures' cameras and parts is checked before any work.
  const CameraOfPicture any = [](const RenderOptions&) { return Camera(); };
  const JsonReader operations = operations_of(json_, path_);
  for (std::size_t i = 0; i < operations.size(); ++i) {
    const JsonReader entry = operations.at(i);
    const std::string op = op_of(entry);
    if (op == "guide") guide_at(entry, any);
    if (op == "remove") remove_at(entry, any);
    if (op == "flip") flip_at(entry, any);
    if (op == "undo" || op == "redo") entry.object({"op"});
  }
}

std::vector<std::string> EditScript::parts() const {
  std::vector<std::string> files;
  const JsonReader operations = operations_of(json_, path_);
  for (std::size_t i = 0; i < operations.size(); ++i)
    if (op_of(operations.at(i)) == "insert") files.push_back(source_at(operations.at(i), folder_of(path_)));
  return files;
}

std::size_t EditScript::size() const { return json_["operations"].size(); }

ScriptStep EditScript::step(std::size_t i, const CameraOfPicture& camera_of_picture) const {
  const JsonReader entry = operations_of(json_, path_).at(i);
  const std::string op = op_of(entry);
  if (op == "undo") return {ScriptStep::Kind::undo, {}};
  if (op == "redo") return {ScriptStep::Kind::redo, {}};
  if (op == "guide") return {ScriptStep::Kind::apply, guide_at(entry, camera_of_picture)};
  if (op == "remove") return {ScriptStep::Kind::apply, remove_at(entry, camera_of_picture)};
  if (op == "flip") return {ScriptStep::Kind::apply, flip_at(entry, camera_of_picture)};
  return {ScriptStep::Kind::apply, insert_at(entry, folder_of(path_))};
}

nlohmann::ordered_json script_of(const std::vector<Operation>& operations, const std::string& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  Json list = Json::array();
  for (const Operation& operation : operations)
    list.push_back(std::visit([&folder](const auto& kind) { return to_json(kind, folder); }, operation));
  return {{"version", kVersion}, {"operations", list}};
}

}  // namespace pointskin::cli
