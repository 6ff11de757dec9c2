// Structs of the C interface as those of C++, and back.
#pragma once

#include <pointskin/c.h>
#include <pointskin/pointskin.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "c/guard.hpp"
#include "c/handles.hpp"

namespace pointskin::c {

/// What the caller's struct says, with defaults for the rest; null: all defaults.
/// @throws Error usage for a constant that there is not
Options options_of(const psk_options* given);
NormalOptions normal_options_of(const psk_normal_options* given);
ReadOptions read_options_of(const psk_read_options* given);
WriteOptions write_options_of(const psk_write_options* given);
RenderOptions render_options_of(const psk_render_options* given);

/// Calls `progress`, if there is one.
std::function<bool(const Progress&)> progress_of(psk_progress progress, void* user);

/// The caller's arrays. @throws Error usage for an unknown type
StridedArray strided(const psk_array& array);
StridedPoints strided(const psk_points* points);

/// True if positions and normals lie in the memory of a device.
bool is_on_device(const psk_points& points);

/// Views of our own arrays.
psk_array array_of(std::span<const Vec3f> values, int memory);
psk_array array_of(std::span<const Triangle> values, int memory);
psk_attribute attribute_of(const Attribute& attribute);
psk_attribute attribute_of(const DeviceAttribute& attribute, std::int64_t rows, int memory);

inline Vec3d vector_of(const double* from) { return {from[0], from[1], from[2]}; }
inline void store(const Vec3d& from, double* to) {
  for (std::size_t axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

/// A mesh on the host: the handle's own, or a copy of one on a device.
class HostMesh {
 public:
  /// @throws Error usage for null
  explicit HostMesh(const psk_mesh* handle);
  [[nodiscard]] const Mesh& operator*() const { return copy_ ? *copy_ : *mesh_; }
  [[nodiscard]] const Mesh* operator->() const { return &**this; }

 private:
  const Mesh* mesh_ = nullptr;
  std::optional<Mesh> copy_;
};

/// One of the two, a mesh or a cloud.
class MeshOrCloud {
 public:
  /// @throws Error usage unless exactly one is there
  MeshOrCloud(const psk_mesh* mesh, const psk_cloud* cloud, const char* what);
  /// f(const Mesh&) or f(const Cloud&).
  template <class F>
  decltype(auto) visit(F&& f) const {
    return mesh_ ? f(**mesh_) : f(*cloud_);
  }

 private:
  std::optional<HostMesh> mesh_;
  const Cloud* cloud_ = nullptr;
};

/// Handles for what was made.
psk_mesh* new_mesh(Mesh mesh);
psk_mesh* new_mesh(const Workspace& workspace, DeviceMesh mesh);
/// Where the caller wants it. @param memory  PSK_HOST or PSK_DEVICE @throws Error usage for anything else
psk_mesh* new_mesh(const Workspace& workspace, DeviceMesh mesh, int memory);
psk_cloud* new_cloud(Cloud cloud);

}  // namespace pointskin::c
