#include "scale/near_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "octree/keys.hpp"

namespace pointskin::scale {
namespace {

/// Samples lie in float, and so do the distances that are compared.
constexpr double kRounding = 1e-5;

/// Squared distances from a point to the nearest and to the farthest place of a cell.
struct DistancesToCell {
  double nearest = 0, farthest = 0;

  DistancesToCell(const Vec3f& point, const octree::Coordinates& cell, int level) {
    const double width = std::ldexp(1.0, -level);
    const auto add = [&](float coordinate, std::int32_t lower) {
      const double below = lower * width - static_cast<double>(coordinate);  // how far the point is below each end
      const double above = below + width;
      const double near = std::max({below, -above, 0.0}), far = std::max(-below, above);
      nearest += near * near;
      farthest += far * far;
    };
    add(point.x, cell.x);
    add(point.y, cell.y);
    add(point.z, cell.z);
  }
};

}  // namespace

/// Of one point.
class NearCells::Search {
 public:
  Search(const NearCells& cells, const Vec3f& point) : all_(cells), point_(point) {}

  std::vector<std::int64_t> run() {
    const Branch root{0, 0, 0, static_cast<std::int64_t>(all_.cells_.size())};
    bound(root);
    collect(root);
    return std::move(found_);
  }

 private:
  /// Cells begin..end - 1, which lie in the cell `key` of a level.
  struct Branch {
    int level;
    std::uint64_t key;
    std::int64_t begin, end;
  };

  [[nodiscard]] DistancesToCell distances_to(const Branch& branch) const {
    return {point_, octree::decode(branch.key), branch.level};
  }

  [[nodiscard]] std::array<Branch, 8> children_of(const Branch& branch) const {
    std::array<Branch, 8> children;
    std::int64_t begin = branch.begin;
    for (std::uint64_t slot = 0; slot < 8; ++slot) {
      const std::uint64_t key = 8 * branch.key + slot;
      const std::uint64_t behind = (key + 1) << 3 * (all_.level_ - branch.level - 1);
      const auto cells =
          all_.cells_.first(static_cast<std::size_t>(branch.end)).subspan(static_cast<std::size_t>(begin));
      const std::int64_t end = begin + (std::ranges::lower_bound(cells, behind) - cells.begin());
      children[slot] = {branch.level + 1, key, begin, end};
      begin = end;
    }
    return children;
  }

  /// One cell's sample is no farther than the cell's farthest place.
  void bound(const Branch& branch) {
    if (branch.begin == branch.end) return;
    if (branch.level == all_.level_) {
      most_ = std::min(most_, (1 + kRounding) * distances_to(branch).farthest);
      return;
    }
    struct Child {
      double nearest;
      const Branch* branch;
    };
    const std::array<Branch, 8> children = children_of(branch);
    std::array<Child, 8> by_distance;
    for (std::size_t slot = 0; slot < 8; ++slot)
      by_distance[slot] = {distances_to(children[slot]).nearest, &children[slot]};
    std::ranges::sort(by_distance, {}, &Child::nearest);
    for (const Child& child : by_distance)
      if (child.nearest <= most_) bound(*child.branch);
  }

  void collect(const Branch& branch) {
    if (branch.begin == branch.end || distances_to(branch).nearest > most_) return;
    if (branch.level == all_.level_) return found_.push_back(branch.begin);
    for (const Branch& child : children_of(branch)) collect(child);
  }

  const NearCells& all_;
  Vec3f point_;
  double most_ = std::numeric_limits<double>::infinity();  // squared distance of the nearest sample
  std::vector<std::int64_t> found_;
};

std::vector<std::int64_t> NearCells::around(const Vec3f& point) const { return Search(*this, point).run(); }

}  // namespace pointskin::scale
