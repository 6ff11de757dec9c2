// Between the host's clouds and meshes and the device's arrays.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "exec/cpu.hpp"
#include "exec/host_array.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "exec/typed_buffer.hpp"
#include "field/attributes.hpp"
#include "octree/frame.hpp"
#include "octree/strays.hpp"
#include "poisson/samples.hpp"
#include "reconstruct/input.hpp"
#include "surface/extract.hpp"

namespace pointskin::detail {

/// An attribute in a space, in the caller's order.
struct AttributeBuffer {
  std::string name;
  exec::TypedBuffer values;

  [[nodiscard]] bool is_label() const { return pointskin::is_label(name, values.type); }
};

/// A cloud in a space, in the caller's order and coordinates.
struct PointBuffers {
  exec::Buffer<Vec3f> positions, normals;     ///< of the run, or borrowed: then never written
  std::vector<AttributeBuffer> attributes{};  ///< those that a mesh is to keep
  exec::Buffer<std::uint8_t>
      added{};  ///< (n) edit/point_kind.hpp; only original points have a say in the isovalue; empty: all are original
  exec::Buffer<std::int32_t> used{};  ///< indices of the points to use, ascending; empty: all of them

  [[nodiscard]] std::int64_t used_count() const { return used.empty() ? positions.size() : used.size(); }
};

/// Memory of the caller's, which is not written.
template <class T>
exec::Buffer<T> borrowed(const DeviceSpan<const T>& from) {
  return exec::Buffer<T>::borrowed(const_cast<T*>(from.data), from.size);
}

inline exec::TypedBuffer borrowed(const DeviceAttribute& from, std::int64_t n) {
  const auto* const bytes = static_cast<const std::uint8_t*>(from.data);
  exec::TypedBuffer to{
      from.type, n, borrowed<std::uint8_t>({bytes, n * static_cast<std::int64_t>(size_of(from.type))}), {}};
  if (from.missing != nullptr) to.missing = borrowed<std::uint8_t>({from.missing, n});
  return to;
}

/// Brings points to the space, whose normals may be missing or zero; without attributes.
/// @throws Error empty_result without points, invalid_input if some are not finite, over_limit beyond 2^31 - 1
template <exec::Space Exec>
PointBuffers upload_some(Exec& ex, const Input& input);

/// Brings points to the space, without attributes. Arrays that are there already are borrowed.
/// @param extent  receives that of the points, unless it is null
/// @throws Error no_normals if there are none or all have zero length, empty_result without points, invalid_input if
/// some
///         are not finite, over_limit beyond 2^31 - 1
template <exec::Space Exec>
PointBuffers upload(Exec& ex, const Input& input, octree::Extent* extent = nullptr);

/// Brings the attributes to the space.
/// @param what  the points are called in errors
/// @throws Error invalid_input if an attribute has another length than the points
template <exec::Space Exec>
std::vector<AttributeBuffer> upload_attributes(Exec& ex, const Input& input, const char* what = "points");

/// Copies a cloud to the space as it is.
/// @throws Error invalid_input for an attribute of another length, over_limit
template <exec::Space Exec>
PointBuffers copy_points(Exec& ex, const Cloud& cloud);

/// Copies points that are in the space to the host.
template <exec::Space Exec>
Cloud download_points(Exec& ex, const DevicePoints& points);

/// Leaves strays out of the points to use. O(n), and nothing if there are none.
/// @throws Error no_normals if there are normals, and those of all others have zero length
template <exec::Space Exec>
void leave_out(Exec& ex, const octree::StrayPoints& strays, PointBuffers& points);

/// The points to use, in the order of their keys.
struct SortedSamples {
  poisson::Samples samples;            ///< positions in the unit cube, normals as they came
  exec::Buffer<std::uint64_t> keys;    ///< (n) point keys
  field::AttributeSamples attributes;  ///< without positions and weights
  exec::Buffer<std::uint8_t> added;    ///< as PointBuffers::added
};

/// Moves the points to use into the unit cube and sorts them. Points that differ in nothing else are sorted by their
/// attributes.
template <exec::Space Exec>
SortedSamples sort_into_cube(Exec& ex, const PointBuffers& points, const octree::Frame& frame);

/// Moves points of the unit cube to where they are in the world, relative to the cloud's origin.
template <exec::Space Exec>
void to_world(Exec& ex, const octree::Frame& frame, ArrayView<Vec3f> positions);

/// Copies a surface to the host, into world coordinates relative to `origin` and the memory that `mesh` has. Every
/// array is freed as soon as it is copied.
template <exec::Space Exec>
void download(Exec& ex, surface::Surface surface, const octree::Frame& frame, const Vec3d& origin, Mesh& mesh);

/// Moves an array to the host, into memory that `to` may have already.
template <class T, exec::Space Exec>
void download_array(Exec& ex, exec::Buffer<T>& from, std::vector<T>& to) {
  if constexpr (Exec::kOnHost)
    exec::resize_to_overwrite(ex, to, static_cast<std::size_t>(from.size()));
  else
    exec::resize_to_overwrite(to, static_cast<std::size_t>(from.size()));
  copy_to_host(ex, from.cview(), to.data());
  from.reset();
}

}  // namespace pointskin::detail
