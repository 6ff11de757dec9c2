// What the public Octree delegates to, one implementation a space.
#pragma once

#include <memory>
#include <vector>

#include <pointskin/octree.hpp>

namespace pointskin {

class Octree::Impl {
 public:
  virtual ~Impl() = default;
  [[nodiscard]] virtual int depth() const = 0;
  [[nodiscard]] virtual std::int64_t points() const = 0;
  [[nodiscard]] virtual Vec3d cube_lower() const = 0;
  [[nodiscard]] virtual double cube_size() const = 0;
  [[nodiscard]] virtual OctreeLevel level(int depth) const = 0;
  [[nodiscard]] virtual std::vector<std::int32_t> point_order() const = 0;
  [[nodiscard]] virtual std::vector<OctreeLeaf> locate(const std::vector<Vec3f>& queries) const = 0;
  [[nodiscard]] virtual OctreeNeighbours nearest(const std::vector<Vec3f>& queries, int k) const = 0;
  [[nodiscard]] virtual OctreeNeighbours within(const std::vector<Vec3f>& queries, double radius) const = 0;
};

namespace octree {

std::shared_ptr<const Octree::Impl> build_on_cpu(const std::vector<Vec3f>& positions, const OctreeOptions& options,
                                                 int threads);
/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::shared_ptr<const Octree::Impl> build_on_cuda(const std::vector<Vec3f>& positions, const OctreeOptions& options,
                                                  int index);

}  // namespace octree
}  // namespace pointskin
