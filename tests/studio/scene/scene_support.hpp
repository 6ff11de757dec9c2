// Small scenes, operations on them, and what tells two surfaces apart.
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <unistd.h>

#include <pointskin/mesh.hpp>

#include "scene/document.hpp"
#include "scene/scene.hpp"
#include "scene/sha256.hpp"
#include "support/shapes.hpp"
#include "support/two_fingers.hpp"

namespace pointskin::test {

template <class T>
void add_bytes(scene::Sha256& sum, const std::vector<T>& values) {
  sum.add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

inline void add_attributes(scene::Sha256& sum, const std::vector<Attribute>& attributes) {
  for (const Attribute& attribute : attributes) {
    sum.add(attribute.name);
    attribute.values.visit([&sum](const auto& values) { add_bytes(sum, values); });
    add_bytes(sum, attribute.values.mask());
  }
}

/// SHA-256 of all that a mesh holds.
inline std::string digest(const Mesh& mesh) {
  scene::Sha256 sum;
  sum.add({reinterpret_cast<const char*>(&mesh.origin), sizeof mesh.origin});
  add_bytes(sum, mesh.vertices);
  add_bytes(sum, mesh.normals);
  add_bytes(sum, mesh.triangles);
  add_attributes(sum, mesh.attributes);
  return sum.finish();
}

inline std::string digest(const Cloud& cloud) {
  scene::Sha256 sum;
  sum.add({reinterpret_cast<const char*>(&cloud.origin), sizeof cloud.origin});
  add_bytes(sum, cloud.positions);
  add_bytes(sum, cloud.normals);
  add_attributes(sum, cloud.attributes);
  return sum.finish();
}

/// A folder of its own, removed at the end.
class SceneFolder {
 public:
  SceneFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "pointskin-scene-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~SceneFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A torus in the plane of front_camera()'s picture, with a colour and a class that tell where a point is.
inline Cloud small_cloud(std::int64_t points = 3000) {
  Cloud cloud = torus_cloud(points, 7);
  std::vector<std::uint8_t> red;
  std::vector<float> height;
  for (const Vec3f& p : cloud.positions) {
    red.push_back(static_cast<std::uint8_t>(100 + 50 * p.x));
    height.push_back(p.z);
  }
  cloud.attributes.push_back({"red", std::move(red)});
  cloud.attributes.push_back({"height", std::move(height)});
  return cloud;
}

inline scene::SceneOptions small_options(int depth = 5) {
  scene::SceneOptions options;
  options.reconstruction.depth = depth;
  return options;
}

/// `text` as an operation; pictures' cameras are front_camera().
inline scene::SceneOperation operation_of_json(const nlohmann::json& json) {
  return scene::operation_of(json, "operation", "/", [](const RenderOptions&) { return front_camera(); });
}
inline scene::SceneOperation operation_from(const std::string& text) {
  return operation_of_json(nlohmann::json::parse(text));
}

/// One of every kind, small enough that all can be done one after another on small_cloud().
inline std::vector<std::string> one_of_every_kind() {
  return {
      R"({"op": "guide", "camera": {}, "stroke": [[250, 200], [350, 190]], "normals": "stroke", "inside_only": false})",
      R"({"op": "guide", "camera": {}, "rectangle": [40, 40, 60, 70], "interval": 0.08, "inside_only": false})",
      R"({"op": "remove", "camera": {}, "area": [[[80, 180], [110, 180], [110, 210]]], "originals": true,
          "layers": "front"})",
      R"({"op": "flip", "camera": {}, "rectangle": [90, 215, 96, 220], "layers": "through"})",
      R"({"op": "insert", "shape": "sphere", "points": 400, "box": {"lower": [-2, -2, 0]}, "scale": 0.3,
          "rotation": {"axis": [1, 2, 3], "degrees": 33}, "translation": [1.2, 1, 0.1], "snap": false})",
      R"({"op": "deform", "handles": [{"region": {"half_space": {"point": [-0.5, 0, 0], "normal": [-1, 0, 0]}}},
          {"region": {"ball": {"centre": [1.2, 0, 0], "radius": 0.2}},
           "rigid": {"axis": [0, 1, 0.3], "point": [0, 0, 0], "degrees": 20.1, "translation": [0.1, 0, 0.07]}}],
          "lattices": [{"box": {"lower": [-2, -2, -2], "upper": [2, 2, 2]}, "spans": [2, 2, 2],
                        "moves": [{"at": [1, 1, 1], "by": [0.2, 0.1, 0.3]}]}]})",
      R"({"op": "boolean", "operation": "difference", "with": {"shape": "sphere", "points": 1500}, "scale": 0.5,
          "translation": [1.1, 0.1, 0.2], "creases": "sampled", "coincidence": 0.7})",
      R"({"op": "orient", "method": "repair", "keep_within_degrees": 60, "confidence": false})",
      R"({"op": "options", "depth": 6, "attributes": true, "screening": 3.3})",
      R"({"op": "orient", "method": "turn"})",
      R"({"op": "guide", "camera": {}, "stroke": [[60, 60], [120, 90]], "inside_only": false})",
  };
}

}  // namespace pointskin::test
