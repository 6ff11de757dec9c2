// The first triangle of a mesh along a ray, by a tree of boxes.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/triangle_distance.hpp"

namespace pointskin::bench {

struct Ray {
  Vec3d origin, direction;  ///< direction of unit length
};

/// Where a ray meets a surface.
struct Hit {
  double range = std::numeric_limits<double>::infinity();  ///< along the ray, world units
  Vec3d normal{};                                          ///< unit length, outward
};

/// A binary tree over the triangles of a mesh, halved at the median of the longest axis.
class RayTree {
 public:
  /// @param mesh  at least one triangle, ids in range, corners finite; not needed afterwards
  /// O(t log t). The order of the triangles at equal centroids does not change what first_hit() returns.
  explicit RayTree(const Mesh& mesh);

  /// The first triangle along `ray`, seen from either side. Edges belong to both of their triangles, so that no ray
  /// slips between them. About O(log t).
  [[nodiscard]] std::optional<Hit> first_hit(const Ray& ray) const;

 private:
  struct Box {
    Vec3d lower, upper;
  };
  struct Node {
    Box box;
    std::int32_t right;         ///< right child, or -1 for a leaf; the left child follows its parent
    std::int32_t first, count;  ///< leaf: its triangles
  };

  std::int32_t build(std::int32_t begin, std::int32_t end, std::vector<Vec3d>& centroids);
  [[nodiscard]] Box enclose(std::int32_t begin, std::int32_t end) const;

  std::vector<EdgedTriangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace pointskin::bench
