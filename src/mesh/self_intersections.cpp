// Pairs of triangles that meet beside what they share: a tree of boxes finds those that may, leaf by leaf; exact
// predicates decide (mesh/triangle_contact.hpp).
#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "mesh/mesh_checks.hpp"
#include "mesh/triangle_contact.hpp"
#include "mesh/triangle_tree.hpp"

namespace pointskin {
namespace {

using exec::Cpu;
using mesh_detail::BoxTree;
using mesh_detail::Contact;
using mesh_detail::MeshTriangle;
using Node = BoxTree::Node;

/// Leaves per block of work.
constexpr std::int64_t kLeafBlock = 128;

MeshTriangle triangle_of(const Mesh& mesh, std::int32_t id) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(id)];
  const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
  return {{corner(0), corner(1), corner(2)}, t};
}

/// A triangle of a leaf and the box around it.
struct Boxed {
  MeshTriangle triangle;
  Vec3f lower, upper;
  std::int32_t id;

  Boxed() = default;
  Boxed(const Mesh& mesh, std::int32_t which) : triangle(triangle_of(mesh, which)), id(which) {
    const auto& [a, b, c] = triangle.corners;
    lower = {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})};
    upper = {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})};
  }
  [[nodiscard]] bool overlaps(const Vec3f& other_lower, const Vec3f& other_upper) const {
    return lower.x <= other_upper.x && other_lower.x <= upper.x && lower.y <= other_upper.y &&
           other_lower.y <= upper.y && lower.z <= other_upper.z && other_lower.z <= upper.z;
  }
};

/// The pairs of a block of leaves, or of all.
struct Found {
  std::int64_t pairs = 0, touching = 0;
  std::vector<IntersectingPair> first;  ///< by ids, without places

  void keep_first(std::int64_t count) {
    const auto by_ids = [](const IntersectingPair& a, const IntersectingPair& b) { return a.triangles < b.triangles; };
    std::sort(first.begin(), first.end(), by_ids);
    if (static_cast<std::int64_t>(first.size()) > count) first.resize(static_cast<std::size_t>(count));
  }
};

/// Every leaf against itself and those after it.
class Search {
 public:
  Search(const Mesh& mesh, const BoxTree& tree, std::int64_t listed, std::vector<std::uint8_t>& involved)
      : mesh_(mesh), tree_(tree), listed_(listed), involved_(involved) {}

  void add_leaf(const Node& leaf, Found& found) const {
    std::array<Boxed, BoxTree::kLeafSize> ours;
    const std::int32_t count = load(leaf, ours);
    std::array<std::int32_t, BoxTree::kMaxDepth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    std::size_t height = 0;
    stack[height++] = 0;
    while (height > 0) {
      const std::int32_t at = stack[--height];
      const Node& node = tree_.nodes()[at];
      if (!node.overlaps(leaf)) continue;
      if (node.is_leaf()) {
        for (std::int32_t i = 0; i < count; ++i)
          add_triangle(ours[static_cast<std::size_t>(i)], leaf.first + i, node, found);
        continue;
      }
      stack[height++] = node.right;
      if (tree_.nodes()[node.right].first > leaf.first) stack[height++] = at + 1;
    }
    if (static_cast<std::int64_t>(found.first.size()) > 2 * listed_) found.keep_first(listed_);
  }

 private:
  std::int32_t load(const Node& leaf, std::array<Boxed, BoxTree::kLeafSize>& triangles) const {
    const std::int32_t count = tree_.end_of_leaf(leaf) - leaf.first;
    for (std::int32_t i = 0; i < count; ++i)
      triangles[static_cast<std::size_t>(i)] = Boxed(mesh_, tree_.id(leaf.first + i));
    return count;
  }

  /// Our triangle, at `slot`, against those of a leaf that have later slots.
  void add_triangle(const Boxed& ours, std::int32_t slot, const Node& leaf, Found& found) const {
    const Vec3f lower{leaf.lower[0], leaf.lower[1], leaf.lower[2]}, upper{leaf.upper[0], leaf.upper[1], leaf.upper[2]};
    if (!ours.overlaps(lower, upper)) return;
    const std::int32_t end = tree_.end_of_leaf(leaf);
    for (std::int32_t other = std::max(leaf.first, slot + 1); other < end; ++other) {
      const Boxed theirs(mesh_, tree_.id(other));
      if (!ours.overlaps(theirs.lower, theirs.upper)) continue;
      const Contact contact = contact_of(ours.triangle, theirs.triangle);
      if (contact != Contact::none) add_pair(ours.id, theirs.id, contact, found);
    }
  }

  void add_pair(std::int32_t a, std::int32_t b, Contact contact, Found& found) const {
    ++found.pairs;
    const bool touching = contact == Contact::touching;
    if (touching) ++found.touching;
    for (const std::int32_t id : {a, b})
      std::atomic_ref(involved_[static_cast<std::size_t>(id)]).store(1, std::memory_order_relaxed);
    found.first.push_back({{std::min(a, b), std::max(a, b)}, touching, {}});
  }

  const Mesh& mesh_;
  const BoxTree& tree_;
  std::int64_t listed_;
  std::vector<std::uint8_t>& involved_;  // shape (t)
};

Found search_all(Cpu& ex, const Search& search, const BoxTree& tree, std::int64_t listed) {
  const ArrayView<const Node> nodes = tree.nodes();
  const exec::Buffer<std::int32_t> leaves =
      exec::select(ex, "leaves", nodes.size, [nodes](std::int64_t i) { return nodes[i].is_leaf(); });
  std::vector<Found> parts(static_cast<std::size_t>(exec::block_count(leaves.size(), kLeafBlock)));
  ex.run_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t b) {
    Found& part = parts[static_cast<std::size_t>(b)];
    for (std::int64_t i = b * kLeafBlock; i < std::min(leaves.size(), (b + 1) * kLeafBlock); ++i)
      search.add_leaf(nodes[leaves.data()[i]], part);
    part.keep_first(listed);
  });
  Found all;
  for (const Found& part : parts) {
    all.pairs += part.pairs;
    all.touching += part.touching;
    all.first.insert(all.first.end(), part.first.begin(), part.first.end());
    if (static_cast<std::int64_t>(all.first.size()) > 2 * listed) all.keep_first(listed);
  }
  all.keep_first(listed);
  return all;
}

void check(Cpu& ex, const Mesh& mesh, const SelfIntersectionOptions& options) {
  if (options.listed < 0) throw Error(ErrorCode::usage, "the number of listed pairs must not be negative");
  mesh_detail::check_indices(ex, mesh);
  if (!mesh_detail::corner_bounds(ex, mesh).finite)
    throw Error(ErrorCode::invalid_input, "the mesh has a vertex that is not finite");
}

}  // namespace

SelfIntersections find_self_intersections(const Mesh& mesh, const SelfIntersectionOptions& options) {
  Cpu ex(options.threads);
  check(ex, mesh, options);
  SelfIntersections result;
  if (mesh.triangles.empty()) return result;
  const BoxTree tree = mesh_detail::tree_of_triangles(ex, mesh, Vec3d{0, 0, 0});
  std::vector<std::uint8_t> involved(mesh.triangles.size(), 0);
  Found found = search_all(ex, Search(mesh, tree, options.listed, involved), tree, options.listed);
  result.pairs = found.pairs;
  result.touching = found.touching;
  result.triangles = std::count(involved.begin(), involved.end(), 1);
  result.listed = std::move(found.first);
  for (IntersectingPair& pair : result.listed) {
    const Vec3d place = place_of_contact(triangle_of(mesh, pair.triangles[0]), triangle_of(mesh, pair.triangles[1]));
    pair.place_world = mesh.origin + place;
  }
  return result;
}

}  // namespace pointskin
