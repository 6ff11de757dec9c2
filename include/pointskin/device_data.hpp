// Points and meshes in the memory of a device: what a program that computes there passes in and gets out without a
// copy.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pointskin/attribute.hpp>
#include <pointskin/cloud.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

/// `size` elements in the memory of a workspace's device, in a row. Owns nothing. On a GPU the host must not look at
/// them.
template <class T>
struct DeviceSpan {
  T* data = nullptr;
  std::int64_t size = 0;

  [[nodiscard]] bool empty() const noexcept { return size == 0; }
};

/// A named scalar of points or vertices in the memory of a device.
struct DeviceAttribute {
  std::string name;
  AttributeType type = AttributeType::float32;
  const void* data = nullptr;             ///< shape (n) of the type
  const std::uint8_t* missing = nullptr;  ///< shape (n), 1 where an integer is missing; null: all are there
};

/// A cloud in the memory of a device: pointers into arrays that the caller owns.
///
/// The arrays are read and never written. They must stay as they are until the call that they are given to returns, and
/// for a workspace on a stream of the caller's until the stream has done what the call enqueued. What fills them must
/// be ordered before the call: enqueued on the workspace's stream, or waited for. In a workspace of several GPUs as one they
/// must be of memory that all of these reach: cudaMalloc's is; that of a pool needs cudaMemPoolSetAccess.
struct DevicePoints {
  Vec3d origin{0, 0, 0};                    ///< world position of point i = origin + positions[i]
  DeviceSpan<const Vec3f> positions;        ///< shape (n), packed floats x, y, z
  DeviceSpan<const Vec3f> normals;          ///< shape (n) or (0); outward, any length
  std::vector<DeviceAttribute> attributes;  ///< each of shape (n)
};

/// A mesh in the memory of a workspace's device. A handle that owns its arrays: copies share them, and they live until
/// the last copy is gone. They are ready in the order of the workspace's stream: work enqueued there after the call
/// that made the mesh may use them; others wait (Workspace::synchronize). The arrays may be changed by the caller.
struct DeviceMesh {
  Vec3d origin{0, 0, 0};                    ///< world position of vertex i = origin + vertices[i]
  DeviceSpan<Vec3f> vertices;               ///< shape (v)
  DeviceSpan<Vec3f> normals;                ///< shape (v) or (0), unit length, outward
  DeviceSpan<Triangle> triangles;           ///< shape (t), ids in [0, v), counter-clockwise seen from outside
  std::vector<DeviceAttribute> attributes;  ///< each of shape (v)
  std::shared_ptr<const void> owner;        ///< of the arrays
};

/// Copies a cloud to the memory of `workspace`. The arrays live as long as `owner` of the result.
struct UploadedCloud : DevicePoints {
  std::shared_ptr<const void> owner;
};

/// Copies a cloud to the device of `workspace`: positions, normals and attributes.
/// @throws Error invalid_input for an attribute of another length, over_limit (memory)
/// O(n). Waits until the cloud may be changed.
UploadedCloud upload(const Workspace& workspace, const Cloud& cloud);

/// Copies a mesh to the host. Waits.
Mesh download(const Workspace& workspace, const DeviceMesh& mesh);

/// Copies points to the host. Waits.
Cloud download(const Workspace& workspace, const DevicePoints& points);

}  // namespace pointskin
