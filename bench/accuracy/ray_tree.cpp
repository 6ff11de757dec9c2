// Sources: Moeller & Trumbore, "Fast, minimum storage ray/triangle intersection", JGT 2, 1997;
// Williams et al., "An efficient and robust ray-box intersection algorithm", JGT 10, 2005.
// Differs: triangles are a little larger than they are, so that rays through an edge hit one of its triangles.
#include "ray_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/vec3.hpp"

namespace pointskin::bench {
namespace {

constexpr std::int32_t kLeafSize = 4;
constexpr double kMargin = 1e-9;  // in barycentric coordinates

/// The range at which `ray` meets `t`, or infinity.
double range_of(const Ray& ray, const EdgedTriangle& t) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const Vec3d p = cross(ray.direction, t.ac);
  const double det = dot(t.ab, p);
  if (det == 0) return kNone;
  const Vec3d from = ray.origin - t.a;
  const double u = dot(from, p) / det;
  if (!(u >= -kMargin && u <= 1 + kMargin)) return kNone;
  const Vec3d q = cross(from, t.ab);
  const double v = dot(ray.direction, q) / det;
  if (!(v >= -kMargin && u + v <= 1 + kMargin)) return kNone;
  const double range = dot(t.ac, q) / det;
  return range > 0 ? range : kNone;
}

/// The range at which the ray enters the box, 0 inside, infinity if it misses it.
double entry(const Vec3d& lower, const Vec3d& upper, const Ray& ray) {
  double begin = 0, end = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] == 0) {
      if (ray.origin[axis] < lower[axis] || ray.origin[axis] > upper[axis])
        return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = (lower[axis] - ray.origin[axis]) / ray.direction[axis];
    const double b = (upper[axis] - ray.origin[axis]) / ray.direction[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return begin <= end ? begin : std::numeric_limits<double>::infinity();
}

}  // namespace

RayTree::RayTree(const Mesh& mesh) {
  std::vector<Vec3d> centroids;
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) {
      return mesh.origin + to_double(mesh.vertices[static_cast<std::size_t>(t[k])]);
    };
    const Vec3d a = corner(0);
    triangles_.push_back({a, corner(1) - a, corner(2) - a});
    centroids.push_back(a + 1.0 / 3 * (triangles_.back().ab + triangles_.back().ac));
  }
  build(0, static_cast<std::int32_t>(triangles_.size()), centroids);
}

RayTree::Box RayTree::enclose(std::int32_t begin, std::int32_t end) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (std::int32_t i = begin; i < end; ++i) {
    const EdgedTriangle& t = triangles_[static_cast<std::size_t>(i)];
    for (const Vec3d& corner : {t.a, t.a + t.ab, t.a + t.ac}) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(box.lower[axis], corner[axis]);
        box.upper[axis] = std::max(box.upper[axis], corner[axis]);
      }
    }
  }
  // What range_of() accepts beside a triangle lies in its box too.
  const Vec3d extent = box.upper - box.lower;
  const double margin = 2 * kMargin * std::max({extent.x, extent.y, extent.z});
  for (std::size_t axis = 0; axis < 3; ++axis) box.lower[axis] -= margin, box.upper[axis] += margin;
  return box;
}

std::int32_t RayTree::build(std::int32_t begin, std::int32_t end, std::vector<Vec3d>& centroids) {
  const auto node = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back({enclose(begin, end), -1, begin, end - begin});
  if (end - begin <= kLeafSize) return node;
  const Box box = nodes_.back().box;
  const Vec3d extent = box.upper - box.lower;
  const std::size_t of_two = extent.x < extent.y ? 1 : 0;
  const std::size_t axis = extent[of_two] < extent.z ? 2 : of_two;
  // Sorts triangles and centroids together, by a permutation.
  std::vector<std::int32_t> order(static_cast<std::size_t>(end - begin));
  std::iota(order.begin(), order.end(), begin);
  const auto middle = order.begin() + (end - begin) / 2;
  std::nth_element(order.begin(), middle, order.end(), [&](std::int32_t a, std::int32_t b) {
    return std::pair{centroids[static_cast<std::size_t>(a)][axis], a} <
           std::pair{centroids[static_cast<std::size_t>(b)][axis], b};
  });
  std::vector<EdgedTriangle> moved;
  std::vector<Vec3d> moved_centroids;
  for (const std::int32_t i : order) {
    moved.push_back(triangles_[static_cast<std::size_t>(i)]);
    moved_centroids.push_back(centroids[static_cast<std::size_t>(i)]);
  }
  std::copy(moved.begin(), moved.end(), triangles_.begin() + begin);
  std::copy(moved_centroids.begin(), moved_centroids.end(), centroids.begin() + begin);
  const std::int32_t half = begin + (end - begin) / 2;
  build(begin, half, centroids);
  const std::int32_t right = build(half, end, centroids);
  nodes_[static_cast<std::size_t>(node)].right = right;
  return node;
}

std::optional<Hit> RayTree::first_hit(const Ray& ray) const {
  double nearest = std::numeric_limits<double>::infinity();
  const EdgedTriangle* found = nullptr;
  const auto entry_of = [&](std::int32_t node) {
    const Box& box = nodes_[static_cast<std::size_t>(node)].box;
    return entry(box.lower, box.upper, ray);
  };
  std::array<std::pair<double, std::int32_t>, 64> stack;  // the tree is balanced: its depth is below 32
  std::size_t height = 0;
  stack[height++] = {entry_of(0), 0};
  while (height > 0) {
    const auto [begin, at] = stack[--height];
    if (!(begin < nearest)) continue;
    const Node& node = nodes_[static_cast<std::size_t>(at)];
    if (node.right < 0) {
      for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
        const EdgedTriangle& triangle = triangles_[static_cast<std::size_t>(i)];
        const double range = range_of(ray, triangle);
        if (range < nearest) nearest = range, found = &triangle;
      }
      continue;
    }
    std::pair near{entry_of(at + 1), at + 1}, far{entry_of(node.right), node.right};
    if (far.first < near.first) std::swap(near, far);
    stack[height++] = far;
    stack[height++] = near;
  }
  if (found == nullptr) return std::nullopt;
  return Hit{nearest, normalized(found->area_vector())};
}

}  // namespace pointskin::bench
