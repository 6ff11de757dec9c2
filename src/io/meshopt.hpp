// Buffers of glTF in meshoptimizer's coding. Where it is built in (kHasMeshoptimizer), by meshoptimizer.
// Source: Khronos, "EXT_meshopt_compression".
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pointskin/mesh.hpp>

namespace pointskin::io {

inline constexpr char kMeshoptExtension[] = "EXT_meshopt_compression";
inline constexpr char kQuantizationExtension[] = "KHR_mesh_quantization";

enum class MeshoptMode { attributes, triangles, indices };
enum class MeshoptFilter { none, octahedral, quaternion, exponential };

/// Rows that are coded together.
struct MeshoptRows {
  std::size_t count = 0, stride = 0;  ///< rows, and bytes of each: of an index where the mode tells of indices
  MeshoptMode mode = MeshoptMode::attributes;
  MeshoptFilter filter = MeshoptFilter::none;

  /// False for lengths that the extension does not know.
  [[nodiscard]] bool is_valid() const;
};

/// Codes rows of a multiple of 4 bytes, at most 256.
std::string encode_rows(const std::string& rows, std::size_t stride);

/// Codes triangles in their order; the corners of one may begin with another of the three.
std::string encode_triangles(const std::vector<Triangle>& triangles, std::size_t vertices);

/// A unit vector as 8 bytes of a row for the octahedral filter, 12 bits each way.
void store_octahedral(const Vec3f& direction, char* to);

/// @returns count * stride bytes, or nothing for what is broken, or promises more than its length can hold
std::optional<std::string> decode_rows(std::string_view packed, const MeshoptRows& rows);

}  // namespace pointskin::io
