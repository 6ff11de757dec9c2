// NumPy's archives of arrays, as numpy.savez writes them: not compressed.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "io/npy.hpp"
#include "io/writers.hpp"
#include "io/zip.hpp"

namespace pointskin::io {
namespace {

/// Makes the files of an archive.
class Arrays {
 public:
  explicit Arrays(const VertexArrays& vertices) : vertices_(vertices) {}

  void add_positions(const std::string& name) {
    const std::vector<Vec3f>& positions = vertices_.positions;
    if (is_zero(vertices_.origin)) return add_vectors(name, positions);
    std::vector<Vec3d> places(positions.size());
    std::transform(positions.begin(), positions.end(), places.begin(),
                   [&](const Vec3f& p) { return world(vertices_.origin, p); });
    add(name, AttributeType::float64, places.size(), 3, places.data(), places.size() * sizeof(Vec3d));
  }

  void add_normals() {
    if (!vertices_.normals.empty()) add_vectors("normals", vertices_.normals);
  }

  void add_triangles(const std::vector<Triangle>& triangles) {
    add("faces", AttributeType::int32, triangles.size(), 3, triangles.data(), triangles.size() * sizeof(Triangle));
  }

  void add_attributes() {
    const std::vector<const Attribute*> colour = byte_colours(vertices_.attributes, true);
    if (!colour.empty()) add_colour(colour);
    for (const Attribute& attribute : vertices_.attributes)
      if (std::find(colour.begin(), colour.end(), &attribute) == colour.end()) add_attribute(attribute);
  }

  [[nodiscard]] std::string archive() const { return zip(files_, false); }

 private:
  /// @param columns  0: the array has one dimension
  void add(const std::string& name, AttributeType type, std::size_t rows, std::int64_t columns, const void* data,
           std::size_t bytes) {
    std::string own = name;
    while (!names_.insert(own).second) own += "_";
    ZipFile file{own + ".npy", npy_header(type, static_cast<std::int64_t>(rows), columns)};
    const std::size_t header = file.bytes.size();
    file.bytes.resize(header + bytes);
    if (bytes > 0) std::memcpy(file.bytes.data() + header, data, bytes);
    files_.push_back(std::move(file));
  }

  void add_vectors(const std::string& name, const std::vector<Vec3f>& vectors) {
    add(name, AttributeType::float32, vectors.size(), 3, vectors.data(), vectors.size() * sizeof(Vec3f));
  }

  void add_colour(const std::vector<const Attribute*>& channels) {
    const std::size_t rows = channels[0]->values.size();
    std::vector<std::uint8_t> joined(rows * channels.size());
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const std::vector<std::uint8_t>& values = channels[c]->values.as<std::uint8_t>();
      for (std::size_t i = 0; i < rows; ++i) joined[i * channels.size() + c] = values[i];
    }
    add(channels.size() == 3 ? "rgb" : "rgba", AttributeType::uint8, rows, static_cast<std::int64_t>(channels.size()),
        joined.data(), joined.size());
  }

  void add_attribute(const Attribute& attribute) {
    const AttributeValues values =
        attribute.values.has_mask() ? attribute.values.converted(type_with_nan(attribute.type())) : attribute.values;
    values.visit([&](const auto& all) {
      add(attribute.name, values.type(), all.size(), 0, all.data(), all.size() * sizeof(all[0]));
    });
  }

  const VertexArrays& vertices_;
  std::vector<ZipFile> files_;
  std::unordered_set<std::string> names_;
};

Blocks format_npz(const VertexArrays& vertices, const std::vector<Triangle>* triangles) {
  check_attributes(vertices);
  Arrays arrays(vertices);
  arrays.add_positions(triangles != nullptr ? "vertices" : "points");
  if (triangles != nullptr) arrays.add_triangles(*triangles);
  arrays.add_normals();
  arrays.add_attributes();
  return cut_into_blocks(arrays.archive(), {});
}

}  // namespace

Blocks format_npz_mesh(const Mesh& mesh, const WriteOptions& /*options*/) {
  return format_npz({mesh.origin, mesh.vertices, mesh.normals, mesh.attributes}, &mesh.triangles);
}

Blocks format_npz_cloud(const Cloud& cloud, const WriteOptions& /*options*/) {
  return format_npz({cloud.origin, cloud.positions, cloud.normals, cloud.attributes}, nullptr);
}

}  // namespace pointskin::io
