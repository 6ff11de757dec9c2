// Points and triangles that lie in arrays of another program, of any type and with any strides.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <pointskin/attribute.hpp>
#include <pointskin/cloud.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/export.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

/// Numbers in somebody's memory, shape (rows, components). Owns nothing. Element (i, j) begins at byte
/// i row_stride_bytes + j component_stride_bytes after `data`, aligned or not.
struct StridedArray {
  const void* data = nullptr;  ///< null: there is no such array
  AttributeType type = AttributeType::float32;
  std::int64_t rows = 0;
  int components = 3;
  std::int64_t row_stride_bytes = 12, component_stride_bytes = 4;  ///< of any sign; 0 repeats an element

  [[nodiscard]] bool exists() const noexcept { return data != nullptr || rows > 0; }
  /// Elements without gaps between them, each at an address that its type allows.
  [[nodiscard]] bool is_packed() const {
    const auto element = static_cast<std::int64_t>(size_of(type));
    return reinterpret_cast<std::uintptr_t>(data) % size_of(type) == 0 && component_stride_bytes == element &&
           row_stride_bytes == element * components;
  }
};

/// A named scalar of points.
struct StridedAttribute {
  std::string name;
  StridedArray values{.components = 1, .row_stride_bytes = 4};  ///< shape (n, 1)
  const std::uint8_t* missing = nullptr;  ///< shape (n): 1 where an integer is missing; null: all are there
};

/// Points in arrays.
struct StridedPoints {
  Vec3d origin{0, 0, 0};   ///< world position of point i = origin + positions[i]
  StridedArray positions;  ///< shape (n, 3)
  StridedArray normals;    ///< shape (n, 3), outward, any length; or none
  std::vector<StridedAttribute> attributes;
};

/// Copies points on the host into a cloud, as read_cloud() does it with those of a file of this type: rows with a
/// coordinate that is not finite or larger than 1e38 are left out and counted, normals that are not finite become zero,
/// and an offset is taken off doubles and integers that float does not hold exactly enough (ReadOptions::shift).
/// @throws Error usage if shapes do not fit together
/// O(n). Deterministic for any ReadOptions::threads.
Cloud cloud_of(const StridedPoints& points, const ReadOptions& options = {});

/// Copies a mesh on the host. Normals get unit length.
/// @param triangles  shape (t, 3), integers: ids in [0, n), counter-clockwise seen from outside
/// @throws Error usage if shapes do not fit together, invalid_input for an id out of range or a vertex that is not
///         finite, over_limit for more than 2^31 - 1 vertices
Mesh mesh_of(const StridedPoints& vertices, const StridedArray& triangles, const ReadOptions& options = {});

/// Places on the host, as doubles. @param array  shape (n, 3) @throws Error usage for another shape
std::vector<Vec3d> vectors_of(const StridedArray& array);

/// Points in the memory of the device of `workspace`, as the library takes them. Packed float arrays and packed
/// attributes are used where they lie, without a copy (see DevicePoints for how long they must stay); all else is
/// copied on the device and lives as long as `owner` of the result. Doubles are rounded to float: subtract what they
/// have in common first, as StridedPoints::origin.
/// @throws Error usage if shapes do not fit together, over_limit (memory)
/// O(n) at most, enqueued on the workspace's stream.
UploadedCloud device_points_of(const Workspace& workspace, const StridedPoints& points);

/// True if device_points_of() would copy neither positions nor normals.
bool is_used_in_place(const StridedPoints& points);

/// True if cloud_of() would leave no point out and change no normal. Points on the host. O(n).
bool are_finite(const StridedPoints& points, int threads = 0);

}  // namespace pointskin
