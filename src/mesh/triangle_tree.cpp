// A tree of boxes (bounding volume hierarchy), as in Ericson, "Real-Time Collision Detection", 2005, ch. 6.
//
// Every leaf but the last is full and splits fall between leaves, so the number of leaves below a node follows from its
// number of triangles, and a subtree of m leaves takes 2m - 1 consecutive nodes. Subtrees can therefore be built in
// parallel, each into its own place, and the tree is the same for any number of threads.
#include "mesh/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace pointskin::mesh_detail {
namespace {

using exec::Buffer;
using Node = TriangleTree::Node;

constexpr std::int64_t kLeafSize = 4;
constexpr std::size_t kParallelSubtrees = 64;
// The tree is balanced, so its depth is below 32 for any number of 32-bit ids.
constexpr std::size_t kMaxDepth = 64;

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

void include(const Vec3d& p, Node& node) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    node.lower[axis] = std::min(node.lower[axis], round_down(p[axis]));
    node.upper[axis] = std::max(node.upper[axis], round_up(p[axis]));
  }
}

void include(const Node& child, Node& node) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    node.lower[axis] = std::min(node.lower[axis], child.lower[axis]);
    node.upper[axis] = std::max(node.upper[axis], child.upper[axis]);
  }
}

/// A subtree to build: node `node` over the slots [begin, end).
struct Subtree {
  std::int64_t node = 0, begin = 0, end = 0;

  [[nodiscard]] std::int64_t leaves() const { return exec::block_count(end - begin, kLeafSize); }
};

/// Builds nodes over `ids`, which it reorders.
class TreeBuilder {
 public:
  TreeBuilder(const Mesh& mesh, const Vec3d& offset, std::int32_t* ids, Node* nodes, const Vec3f* centroids)
      : mesh_(mesh), offset_(offset), ids_(ids), nodes_(nodes), centroids_(centroids) {}

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
    const std::int64_t middle = tree.begin + left_leaves * kLeafSize;
    float Vec3f::*const axis = longest_axis(tree);
    std::nth_element(ids_ + tree.begin, ids_ + middle, ids_ + tree.end, [&](std::int32_t a, std::int32_t b) {
      return std::pair{centroids_[a].*axis, a} < std::pair{centroids_[b].*axis, b};
    });
    const Subtree left{tree.node + 1, tree.begin, middle};
    const Subtree right{tree.node + 2 * left_leaves, middle, tree.end};
    nodes_[tree.node].right = static_cast<std::int32_t>(right.node);
    nodes_[tree.node].first = -1;
    return {left, right};
  }

  [[nodiscard]] float Vec3f::*longest_axis(const Subtree& tree) const {
    Vec3f lower = centroids_[ids_[tree.begin]], upper = lower;
    for (std::int64_t i = tree.begin; i < tree.end; ++i) {
      const Vec3f& c = centroids_[ids_[i]];
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
    Node& node = nodes_[tree.node];
    clear(node);
    node.right = -1;
    node.first = static_cast<std::int32_t>(tree.begin);
    for (std::int64_t i = tree.begin; i < tree.end; ++i)
      for (const std::int32_t vertex : mesh_.triangles[static_cast<std::size_t>(ids_[i])])
        include(plus(offset_, to_double(mesh_.vertices[static_cast<std::size_t>(vertex)])), node);
  }

  void enclose_children(std::int64_t node) const {
    clear(nodes_[node]);
    include(nodes_[node + 1], nodes_[node]);
    include(nodes_[nodes_[node].right], nodes_[node]);
  }

  const Mesh& mesh_;
  Vec3d offset_;
  std::int32_t* ids_;
  Node* nodes_;
  const Vec3f* centroids_;
};

double squared_distance_to_box(const Vec3d& p, const Node& node) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double below = static_cast<double>(node.lower[axis]) - p[axis];
    const double above = p[axis] - static_cast<double>(node.upper[axis]);
    const double outside = std::max({below, above, 0.0});
    sum += outside * outside;
  }
  return sum;
}

/// Whether the part of the line in [0, 1] meets the box. @param inverse  1 / line, infinite along axes it is level to
bool meets_box(const Vec3d& from, const Vec3d& inverse, const Node& node) {
  double enter = 0, leave = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double below = static_cast<double>(node.lower[axis]) - from[axis];
    const double above = static_cast<double>(node.upper[axis]) - from[axis];
    if (std::isinf(inverse[axis])) {
      if (below > 0 || above < 0) return false;
      continue;
    }
    const double a = below * inverse[axis], b = above * inverse[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

bool meets_triangle(const Vec3d& from, const Vec3d& line, const EdgedTriangle& t) {
  const Vec3d p = cross(line, t.ac);
  const double determinant = dot(t.ab, p);
  if (determinant == 0) return false;
  const Vec3d s = minus(from, t.a);
  const double u = dot(s, p) / determinant;
  const Vec3d q = cross(s, t.ab);
  const double v = dot(line, q) / determinant;
  const double along = dot(t.ac, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && along >= 0 && along <= 1;
}

}  // namespace

EdgedTriangle edged_triangle(const Mesh& mesh, const Vec3d& offset, std::int64_t id) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(id)];
  const auto corner = [&](std::size_t k) { return to_double(mesh.vertices[static_cast<std::size_t>(t[k])]); };
  // Edges are differences of floats, exact in double; they do not pass through the offset.
  return {plus(offset, corner(0)), minus(corner(1), corner(0)), minus(corner(2), corner(0))};
}

TriangleTree::TriangleTree(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset) {
  const auto count = static_cast<std::int64_t>(mesh.triangles.size());
  ids_ = Buffer<std::int32_t>(ex.pool(), count);
  triangles_ = Buffer<EdgedTriangle>(ex.pool(), count);
  nodes_ = Buffer<Node>(ex.pool(), 2 * exec::block_count(count, kLeafSize) - 1);
  Buffer<Vec3f> centroids(ex.pool(), count);
  exec::for_each(ex, "tree", count, [&](std::int64_t i) {
    const EdgedTriangle t = edged_triangle(mesh, Vec3d{0, 0, 0}, i);
    const Vec3d centroid = plus(t.a, times(1.0 / 3, plus(t.ab, t.ac)));
    centroids.data()[i] = {static_cast<float>(centroid[0]), static_cast<float>(centroid[1]),
                           static_cast<float>(centroid[2])};
    ids_.data()[i] = static_cast<std::int32_t>(i);
  });
  TreeBuilder(mesh, offset, ids_.data(), nodes_.data(), centroids.data()).build(ex, count);
  exec::for_each(ex, "tree", count,
                 [&](std::int64_t slot) { triangles_.data()[slot] = edged_triangle(mesh, offset, ids_.data()[slot]); });
}

Nearest TriangleTree::nearest(const Vec3d& p, std::int32_t hint) const {
  Nearest best;
  const auto visit = [&](std::int32_t slot) {
    const double d = squared_distance(p, triangle(slot));
    if (d < best.squared_distance || (d == best.squared_distance && id(slot) < id(best.slot))) best = {d, slot};
  };
  if (hint >= 0) visit(hint);

  struct Waiting {
    std::int32_t node;
    double squared_distance;
  };
  std::array<Waiting, kMaxDepth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as it grows
  std::size_t height = 0;
  stack[height++] = {0, 0};
  while (height > 0) {
    Waiting at = stack[--height];
    while (at.squared_distance <= best.squared_distance) {
      const Node& node = nodes_.data()[at.node];
      if (node.right < 0) {
        const auto end = static_cast<std::int32_t>(std::min<std::int64_t>(node.first + kLeafSize, ids_.size()));
        for (std::int32_t slot = node.first; slot < end; ++slot) visit(slot);
        break;
      }
      const std::int32_t left = at.node + 1;
      Waiting near{left, squared_distance_to_box(p, nodes_.data()[left])};
      Waiting far{node.right, squared_distance_to_box(p, nodes_.data()[node.right])};
      if (far.squared_distance < near.squared_distance) std::swap(near, far);
      if (far.squared_distance <= best.squared_distance) stack[height++] = far;
      at = near;
    }
  }
  return best;
}

bool TriangleTree::is_between(const Vec3d& from, const Vec3d& to) const {
  const Vec3d line = minus(to, from);
  const Vec3d inverse{1 / line[0], 1 / line[1], 1 / line[2]};
  std::array<std::int32_t, kMaxDepth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as it grows
  std::size_t height = 0;
  stack[height++] = 0;
  while (height > 0) {
    const std::int32_t at = stack[--height];
    const Node& node = nodes_.data()[at];
    if (!meets_box(from, inverse, node)) continue;
    if (node.right >= 0) {
      stack[height++] = node.right;
      stack[height++] = at + 1;
      continue;
    }
    const auto end = static_cast<std::int32_t>(std::min<std::int64_t>(node.first + kLeafSize, ids_.size()));
    for (std::int32_t slot = node.first; slot < end; ++slot)
      if (meets_triangle(from, line, triangle(slot))) return true;
  }
  return false;
}

}  // namespace pointskin::mesh_detail
