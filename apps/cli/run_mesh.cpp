#include "run_mesh.hpp"

#include <pointskin/device.hpp>

namespace pointskin::cli {

void RunMesh::make(Reconstructor& reconstructor, const Cloud& cloud, const Options& options) {
  const bool has_attributes = options.attributes || options.density || options.weakness;
  if (workspace_.device().kind == DeviceKind::cuda && !has_attributes)
    on_device_ = reconstructor.reconstruct_on_device(cloud, options);
  else
    mesh_ = reconstructor.reconstruct(cloud, options);
}

std::int64_t RunMesh::triangles() const {
  return on_device_.owner ? on_device_.triangles.size : static_cast<std::int64_t>(mesh_.triangles.size());
}

void RunMesh::write(const std::string& path, const WriteOptions& options) const {
  if (on_device_.owner)
    write_mesh(path, workspace_, on_device_, options);
  else
    write_mesh(path, mesh_, options);
}

MeshGlance RunMesh::glance(int threads) const {
  return on_device_.owner ? glance_at(workspace_, on_device_) : glance_at(mesh_, threads);
}

const Mesh& RunMesh::on_host() {
  if (on_device_.owner) {
    mesh_ = download(workspace_, on_device_);
    on_device_ = {};
  }
  return mesh_;
}

}  // namespace pointskin::cli
