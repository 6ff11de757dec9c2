// A bounding volume hierarchy, as in Ericson, "Real-Time Collision Detection", 2005, ch. 6.
//
// Every leaf but the last is full and splits fall between leaves, so the number of leaves below a node follows from its
// number of things, and a subtree of m leaves takes 2m - 1 consecutive nodes. Subtrees can therefore be built in
// parallel, each into its own place, and the tree is the same for any number of threads.
#include "mesh/box_tree.hpp"

#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

namespace pointskin::mesh_detail {
namespace {

using Node = BoxTree::Node;
using Include = std::function<void(std::int32_t id, Node& node)>;

constexpr std::size_t kParallelSubtrees = 64;

float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafterf(f, -std::numeric_limits<float>::infinity()) : f;
}

float round_up(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafterf(f, std::numeric_limits<float>::infinity()) : f;
}

void clear(Node& node) {
  std::fill(node.lower, node.lower + 3, std::numeric_limits<float>::infinity());
  std::fill(node.upper, node.upper + 3, -std::numeric_limits<float>::infinity());
}

void include_box(const Node& child, Node& node) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    node.lower[axis] = std::min(node.lower[axis], child.lower[axis]);
    node.upper[axis] = std::max(node.upper[axis], child.upper[axis]);
  }
}

/// A subtree to build: node `node` over the slots [begin, end).
struct Subtree {
  std::int64_t node = 0, begin = 0, end = 0;

  [[nodiscard]] std::int64_t leaves() const { return exec::block_count(end - begin, BoxTree::kLeafSize); }
};

/// Builds nodes over `ids`, which it reorders.
class TreeBuilder {
 public:
  TreeBuilder(std::int32_t* ids, Node* nodes, const Vec3f* centres, const Include& include)
      : ids_(ids), nodes_(nodes), centres_(centres), include_(include) {}

  void build(exec::Cpu& ex, std::int64_t count) const {
    std::vector<Subtree> open{{0, 0, count}};
    std::vector<Subtree> halved;
    // The leftmost subtree never has more leaves than the others, so while it can be halved all of them can.
    while (open.size() < kParallelSubtrees && open.front().leaves() > 1) {
      std::vector<Subtree> halves(2 * open.size());
      ex.run_blocks(static_cast<std::int64_t>(open.size()), [&](std::int64_t b) {
        const auto i = static_cast<std::size_t>(b);
        std::tie(halves[2 * i], halves[2 * i + 1]) = halve(open[i]);
      });
      halved.insert(halved.end(), open.begin(), open.end());
      open = std::move(halves);
    }
    ex.run_blocks(static_cast<std::int64_t>(open.size()),
                  [&](std::int64_t i) { build_below(open[static_cast<std::size_t>(i)]); });
    for (auto tree = halved.rbegin(); tree != halved.rend(); ++tree) enclose_children(tree->node);
  }

 private:
  /// Splits `tree` at the median of its longest axis.
  [[nodiscard]] std::pair<Subtree, Subtree> halve(const Subtree& tree) const {
    const std::int64_t left_leaves = tree.leaves() / 2;
    const std::int64_t middle = tree.begin + left_leaves * BoxTree::kLeafSize;
    float Vec3f::*const axis = longest_axis(tree);
    std::nth_element(ids_ + tree.begin, ids_ + middle, ids_ + tree.end, [&](std::int32_t a, std::int32_t b) {
      const float at_a = centres_[a].*axis, at_b = centres_[b].*axis;
      return at_a != at_b ? at_a < at_b : precedes(a, b);
    });
    const Subtree left{tree.node + 1, tree.begin, middle};
    const Subtree right{tree.node + 2 * left_leaves, middle, tree.end};
    nodes_[tree.node].right = static_cast<std::int32_t>(right.node);
    nodes_[tree.node].first = static_cast<std::int32_t>(tree.begin);
    return {left, right};
  }

  /// An order that the ids decide only where the centres are the same.
  [[nodiscard]] bool precedes(std::int32_t a, std::int32_t b) const {
    const Vec3f &p = centres_[a], &q = centres_[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  }

  [[nodiscard]] float Vec3f::*longest_axis(const Subtree& tree) const {
    Vec3f lower = centres_[ids_[tree.begin]], upper = lower;
    for (std::int64_t i = tree.begin; i < tree.end; ++i) {
      const Vec3f& c = centres_[ids_[i]];
      lower = {std::min(lower.x, c.x), std::min(lower.y, c.y), std::min(lower.z, c.z)};
      upper = {std::max(upper.x, c.x), std::max(upper.y, c.y), std::max(upper.z, c.z)};
    }
    const float x = upper.x - lower.x, y = upper.y - lower.y, z = upper.z - lower.z;
    if (x >= y && x >= z) return &Vec3f::x;
    return y >= z ? &Vec3f::y : &Vec3f::z;
  }

  void build_below(const Subtree& tree) const {
    if (tree.leaves() <= 1) return make_leaf(tree);
    const auto [left, right] = halve(tree);
    build_below(left);
    build_below(right);
    enclose_children(tree.node);
  }

  void make_leaf(const Subtree& tree) const {
    std::sort(ids_ + tree.begin, ids_ + tree.end, [&](std::int32_t a, std::int32_t b) { return precedes(a, b); });
    Node& node = nodes_[tree.node];
    clear(node);
    node.right = -1;
    node.first = static_cast<std::int32_t>(tree.begin);
    for (std::int64_t i = tree.begin; i < tree.end; ++i) include_(ids_[i], node);
  }

  void enclose_children(std::int64_t node) const {
    clear(nodes_[node]);
    include_box(nodes_[node + 1], nodes_[node]);
    include_box(nodes_[nodes_[node].right], nodes_[node]);
  }

  std::int32_t* ids_;
  Node* nodes_;
  const Vec3f* centres_;
  const Include& include_;
};

}  // namespace

void include_point(const Vec3d& p, Node& node) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    node.lower[axis] = std::min(node.lower[axis], round_down(p[axis]));
    node.upper[axis] = std::max(node.upper[axis], round_up(p[axis]));
  }
}

BoxTree::BoxTree(exec::Cpu& ex, ArrayView<const Vec3f> centres, const Include& include)
    : ids_(ex.pool(), centres.size), nodes_(ex.pool(), 2 * exec::block_count(centres.size, kLeafSize) - 1) {
  exec::for_each(ex, "tree", size(), [&](std::int64_t i) { ids_.data()[i] = static_cast<std::int32_t>(i); });
  TreeBuilder(ids_.data(), nodes_.data(), centres.data, include).build(ex, size());
}

}  // namespace pointskin::mesh_detail
