#include "scene/camera_json.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/vector_json.hpp"

namespace pointskin::scene {
namespace {

using Json = nlohmann::ordered_json;

Matrix4 matrix_at(const JsonReader& json) {
  Matrix4 matrix{};
  const std::vector<double> numbers = json.numbers(matrix.size());
  std::copy(numbers.begin(), numbers.end(), matrix.begin());
  return matrix;
}

int size_at(const JsonReader& json, const char* key, int otherwise) {
  constexpr int kMost = 16384;
  return json.has(key) ? static_cast<int>(json.at(key).whole_number(1, kMost)) : otherwise;
}

UpAxis up_at(const JsonReader& json) {
  const std::string word = json.one_of({"x", "y", "z", "-x", "-y", "-z", "+x", "+y", "+z"});
  const bool minus = word.front() == '-';
  switch (word.back()) {
    case 'x':
      return minus ? UpAxis::minus_x : UpAxis::x;
    case 'y':
      return minus ? UpAxis::minus_y : UpAxis::y;
    default:
      return minus ? UpAxis::minus_z : UpAxis::z;
  }
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
  options.width = size_at(json, "width", options.width);
  options.height = size_at(json, "height", options.height);
  if (json.has("azimuth")) options.azimuth_degrees = json.at("azimuth").number();
  if (json.has("elevation")) options.elevation_degrees = json.at("elevation").number();
  if (json.has("orthographic") && json.at("orthographic").boolean()) options.projection = Projection::orthographic;
  if (json.has("up")) options.up = up_at(json.at("up"));
  return options;
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

}  // namespace

Camera read_camera(const JsonReader& json, const CameraOfPicture& camera_of_picture) {
  if (!json.has("view")) return camera_of_picture(picture_at(json));
  json.object({"view", "projection", "width", "height"});
  Camera camera;
  camera.view = matrix_at(json.at("view"));
  camera.projection = matrix_at(json.at("projection"));
  camera.width = json.at("width").number();
  camera.height = json.at("height").number();
  return camera;
}

Json camera_json(const Camera& camera) {
  return {{"view", camera.view}, {"projection", camera.projection}, {"width", camera.width}, {"height", camera.height}};
}

std::vector<Pixel> read_pixels(const JsonReader& json) {
  std::vector<Pixel> pixels;
  json.array();
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::vector<double> xy = json.at(i).numbers(2);
    pixels.push_back({xy[0], xy[1]});
  }
  return pixels;
}

Area read_area(const JsonReader& json) {
  Area area;
  if (json.has("rectangle")) {
    const std::vector<double> r = json.at("rectangle").numbers(4);
    area.push_back({{r[0], r[1]}, {r[2], r[1]}, {r[2], r[3]}, {r[0], r[3]}});
  } else if (json.has("area")) {
    const JsonReader polygons = json.at("area");
    polygons.array();
    for (std::size_t i = 0; i < polygons.size(); ++i) area.push_back(read_pixels(polygons.at(i)));
  }
  return area;
}

Similarity read_placement(const JsonReader& json) {
  Similarity placement;
  if (json.has("scale")) placement.scale = json.at("scale").number();
  if (json.has("rotation")) placement.rotation = rotation_at(json.at("rotation"));
  if (json.has("translation")) placement.translation = json.at("translation").vector();
  return placement;
}

void write_placement(const Similarity& placement, Json& json) {
  json["scale"] = placement.scale;
  json["rotation"] = placement.rotation;
  json["translation"] = placement.translation;
}

}  // namespace pointskin::scene
