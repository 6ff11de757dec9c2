// Meshes and points as bytes for a page: quantised, each array a section, with a header that says where it lies.
//
// "PSKB", then as 32-bit words the version 1, the length of the header, and 0; the header, JSON in UTF-8, filled up with
// spaces to a multiple of 8; the sections, each at a multiple of 8 behind it. docs/studio.md has the table of sections.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>

namespace pointskin::studio::wire {

/// A number per vertex or point, under the name that a page asks for it by.
struct Values {
  std::string name;
  std::vector<float> values;
};

struct MeshCoding {
  bool compressed = false;           ///< by meshoptimizer's codecs; the order of vertices and triangles stays
  std::vector<Values> values{};      ///< each of shape (v)
  std::vector<std::uint8_t> tint{};  ///< shape (v) or (0): a class per vertex, which the page colours
  int threads = 1;                   ///< that encode; 0: as many as copying can use
};

/// The mesh with positions of 16 bits an axis in its box and normals of 2 bytes. Red, green and blue of the mesh, if it
/// has them, become colours.
/// @throws Error usage if values are of another shape
/// O(v + t). Deterministic.
std::vector<std::byte> encode_mesh(const Mesh& mesh, const MeshCoding& coding);

/// A blob that is not compressed, compressed. @throws Error internal if it is none
std::vector<std::byte> compressed(const std::vector<std::byte>& raw);

/// Points of a cloud that a page draws.
struct PointSet {
  Vec3d origin{};                     ///< world units
  std::vector<Vec3f> positions;       ///< shape (n), relative to the origin
  std::vector<Vec3f> normals;         ///< shape (n) or (0)
  std::vector<std::uint8_t> colours;  ///< shape (4 n) or (0): red, green, blue, 255
  std::vector<std::uint8_t> tint;     ///< shape (n) or (0)
};

/// The same for points. @param box  to quantise in: that of the whole cloud, so that its parts fit together
std::vector<std::byte> encode_points(const PointSet& points, const Bounds& box, bool compressed);

/// The places of `positions` in an order of which every beginning is an even choice: their Morton order, read with
/// bit-reversed indices. O(n log n). Deterministic.
std::vector<std::int64_t> even_order(const std::vector<Vec3f>& positions);

}  // namespace pointskin::studio::wire
