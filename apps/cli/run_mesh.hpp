// The mesh of a run, where it was made, and on the host once somebody asks for it there.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include <pointskin/components.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin::cli {

class RunMesh {
 public:
  explicit RunMesh(Workspace workspace) : workspace_(std::move(workspace)) {}

  /// On a GPU the mesh stays there, unless it has attributes. @throws Error as Reconstructor::reconstruct
  void make(Reconstructor& reconstructor, const Cloud& cloud, const Options& options);

  [[nodiscard]] std::int64_t triangles() const;
  /// @throws Error as write_mesh
  void write(const std::string& path, const WriteOptions& options) const;
  [[nodiscard]] MeshGlance glance(int threads) const;
  /// From now on the mesh is on the host alone.
  const Mesh& on_host();

 private:
  Workspace workspace_;
  DeviceMesh on_device_;  // empty once the mesh is on the host
  Mesh mesh_;
};

}  // namespace pointskin::cli
