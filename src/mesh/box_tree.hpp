// A binary tree of boxes over things in space: triangles, points.
#pragma once

#include <pointskin/vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

#include "core/array_view.hpp"
#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::mesh_detail {

/// A tree over n things, halved at the median of the longest axis of their centres, a few things a leaf. A slot is a
/// place in the order of the leaves; things that are near each other have slots near each other.
/// Memory: 4 bytes a thing and 32 bytes a node, a node for every two things.
class BoxTree {
 public:
  /// A box and what it holds. Nodes lie in preorder: the left child of an inner node follows it.
  struct Node {
    float lower[3], upper[3];  ///< rounded outwards
    std::int32_t right;        ///< right child, or -1 for a leaf
    std::int32_t first;        ///< first slot below it

    [[nodiscard]] bool is_leaf() const { return right < 0; }
    [[nodiscard]] bool overlaps(const Node& other) const {
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (lower[axis] > other.upper[axis] || other.lower[axis] > upper[axis]) return false;
      return true;
    }
  };

  static constexpr std::int64_t kLeafSize = 4;
  /// The tree is balanced, so its depth is below 32 for any number of 32-bit ids.
  static constexpr std::size_t kMaxDepth = 64;

  BoxTree() = default;
  /// @param centres  shape (n), n >= 1: where the things are
  /// @param include  grows the box of a node by thing `id`; called once for every thing, on any thread
  /// O(n log n). Deterministic for any number of threads, and the same for any order of the things, those with the
  /// same centre apart.
  BoxTree(exec::Cpu& ex, ArrayView<const Vec3f> centres,
          const std::function<void(std::int32_t id, Node& node)>& include);

  [[nodiscard]] std::int64_t size() const { return ids_.size(); }
  [[nodiscard]] std::int32_t id(std::int64_t slot) const { return ids_.data()[slot]; }
  [[nodiscard]] ArrayView<const Node> nodes() const { return nodes_.cview(); }
  [[nodiscard]] std::int32_t end_of_leaf(const Node& leaf) const {
    return static_cast<std::int32_t>(std::min<std::int64_t>(leaf.first + kLeafSize, size()));
  }

  /// Calls visit(slot) for everything whose box is not farther from `p` than the root of `squared_bound`, which visit
  /// may lower, and for some of the rest; near boxes first.
  template <class Visit>
  void visit_near(const Vec3d& p, const double& squared_bound, const Visit& visit) const;

 private:
  exec::Buffer<std::int32_t> ids_;  // shape (n), slot to id
  exec::Buffer<Node> nodes_;
};

/// Makes the box of `node` hold `p`.
void include_point(const Vec3d& p, BoxTree::Node& node);

inline double squared_distance_to_box(const Vec3d& p, const BoxTree::Node& node) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double below = static_cast<double>(node.lower[axis]) - p[axis];
    const double above = p[axis] - static_cast<double>(node.upper[axis]);
    const double outside = std::max({below, above, 0.0});
    sum += outside * outside;
  }
  return sum;
}

template <class Visit>
void BoxTree::visit_near(const Vec3d& p, const double& squared_bound, const Visit& visit) const {
  struct Waiting {
    std::int32_t node;
    double squared_distance;
  };
  std::array<Waiting, kMaxDepth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as it grows
  std::size_t height = 0;
  stack[height++] = {0, 0};
  while (height > 0) {
    Waiting at = stack[--height];
    while (at.squared_distance <= squared_bound) {
      const Node& node = nodes_.data()[at.node];
      if (node.is_leaf()) {
        const std::int32_t end = end_of_leaf(node);
        for (std::int32_t slot = node.first; slot < end; ++slot) visit(slot);
        break;
      }
      const std::int32_t left = at.node + 1;
      Waiting near{left, squared_distance_to_box(p, nodes_.data()[left])};
      Waiting far{node.right, squared_distance_to_box(p, nodes_.data()[node.right])};
      if (far.squared_distance < near.squared_distance) std::swap(near, far);
      if (far.squared_distance <= squared_bound) stack[height++] = far;
      at = near;
    }
  }
}

}  // namespace pointskin::mesh_detail
