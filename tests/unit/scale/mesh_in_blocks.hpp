// A mesh as extraction makes it, and what blocks have of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <pointskin/vector.hpp>

#include "octree/keys.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {

inline constexpr int kDepth = 6, kCellLevel = 3, kCutLevel = 2;
inline constexpr std::int32_t kSide = 1 << kDepth;
inline constexpr std::uint64_t kEnd = std::uint64_t{1} << 3 * kDepth;

inline std::uint64_t finest_key(std::uint64_t cell, int level) { return cell << 3 * (kDepth - level); }

/// A mesh as extraction makes it, but of random vertices and triangles: only keys, cells and segments matter.
struct Whole {
  std::vector<std::uint64_t> keys;
  std::vector<Vec3f> positions;
  std::vector<std::uint16_t> labels;
  std::vector<Vec3f> normals;  ///< of unit length
  std::vector<float> values;   ///< that change from cell to cell and a little within one
  std::vector<Triangle> triangles;
  std::vector<std::uint64_t> cells;
  std::vector<std::uint8_t> segments;
};

/// The cells of the finest level within half a cell's width of a sphere that the cube cuts off.
inline std::vector<octree::Coordinates> cells_of_sphere() {
  std::vector<octree::Coordinates> cells;
  for (std::int32_t x = 0; x < kSide; ++x)
    for (std::int32_t y = 0; y < kSide; ++y)
      for (std::int32_t z = 0; z < kSide; ++z) {
        const double radius = std::hypot(x - 40.0, y - 36.0, z - 30.0);
        if (std::abs(radius - 28) < 0.7) cells.push_back({x, y, z});
      }
  return cells;
}

/// @param density  share of the triangles that are made
inline Whole make_whole(std::uint64_t seed, double density = 1) {
  Random random(seed);
  Whole whole;
  std::map<std::uint64_t, std::vector<std::int32_t>> vertices_at;  // by corner
  const std::vector<octree::Coordinates> cells = cells_of_sphere();
  const auto coordinate = [&] { return static_cast<float>(random.unit()); };
  const auto corner_of = [](const octree::Coordinates& cell, int slot) {
    return octree::encode(
        {cell.x + octree::slot_x(slot), cell.y + octree::slot_y(slot), cell.z + octree::slot_z(slot)});
  };
  for (const octree::Coordinates& cell : cells)
    for (int slot = 0; slot < 8; ++slot) vertices_at[corner_of(cell, slot)];
  for (auto& [key, vertices] : vertices_at)
    for (int i = random.below(4); i >= 0; --i) {
      vertices.push_back(static_cast<std::int32_t>(whole.keys.size()));
      whole.keys.push_back(key);
      whole.positions.push_back({coordinate(), coordinate(), coordinate()});
      whole.labels.push_back(static_cast<std::uint16_t>(random.below(1 << 16)));
    }
  for (const std::uint8_t segment : {5, 6, 69, 70}) {
    std::vector<std::pair<std::uint64_t, octree::Coordinates>> in_order;
    for (const octree::Coordinates& cell : cells)
      if (random.below(3) > 0) in_order.emplace_back(octree::encode(cell), cell);
    std::sort(in_order.begin(), in_order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [key, cell] : in_order)
      for (int i = random.below(3); i >= 0; --i) {
        if (random.unit() > density) continue;
        Triangle triangle;
        for (std::int32_t& corner : triangle) {
          const std::vector<std::int32_t>& there = vertices_at[corner_of(cell, random.below(8))];
          corner = there[static_cast<std::size_t>(random.below(static_cast<int>(there.size())))];
        }
        whole.triangles.push_back(triangle);
        whole.cells.push_back(key);
        whole.segments.push_back(segment);
      }
  }
  for (const std::uint64_t key : whole.keys) {
    const octree::Coordinates c = octree::decode(key);
    const auto wave = [](std::int32_t x, double length) { return std::sin(x / length); };
    whole.values.push_back(static_cast<float>(wave(c.x, 3) * wave(c.y, 4) * wave(c.z, 5) + 0.2 * random.unit() - 0.1));
    const Vec3f n{coordinate() - 0.5F, coordinate() - 0.5F, coordinate() + 0.1F};
    const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    whole.normals.push_back({n.x / length, n.y / length, n.z / length});
  }
  return whole;
}

/// What a block has: own cells, all around that share a cell of `kCellLevel` with a corner of one, and of the rest what
/// chance gives.
/// @param others_wrong  values beyond its own vertices are
inline Whole part_of(const Whole& whole, std::uint64_t begin, std::uint64_t end, Random& random,
                     bool others_wrong = true) {
  const auto owns = [&](std::uint64_t key) { return key >= begin && key < end; };
  const auto inner_of = [](std::uint64_t key) {
    const octree::Coordinates c = octree::decode(key);
    return octree::Coordinates{std::min(c.x, kSide - 1), std::min(c.y, kSide - 1), std::min(c.z, kSide - 1)};
  };
  const auto cell_of = [](std::uint64_t key) { return key >> 3 * (kDepth - kCellLevel); };
  std::vector<char> needed(whole.keys.size(), 0);
  std::map<std::uint64_t, bool> cell_needed;
  for (std::size_t t = 0; t < whole.triangles.size(); ++t)
    if (owns(whole.cells[t]))
      for (const std::int32_t v : whole.triangles[t])
        cell_needed[cell_of(whole.keys[static_cast<std::size_t>(v)])] = true;
  Whole part;
  std::vector<std::int32_t> number(whole.keys.size(), -1);
  std::map<std::uint64_t, bool> cell_taken;  // cells of the ring come whole or not at all
  for (std::size_t v = 0; v < whole.keys.size(); ++v) {
    const std::uint64_t cell = cell_of(whole.keys[v]);
    if (!cell_taken.contains(cell)) cell_taken[cell] = cell_needed.contains(cell) || random.below(3) == 0;
    const bool is_own = owns(octree::encode(inner_of(whole.keys[v])));
    if (!is_own && !cell_taken[cell]) continue;
    number[v] = static_cast<std::int32_t>(part.keys.size());
    part.keys.push_back(whole.keys[v]);
    part.positions.push_back(is_own || !others_wrong ? whole.positions[v] : Vec3f{-1, -1, -1});
    part.labels.push_back(is_own ? whole.labels[v] : std::uint16_t{0});
    part.normals.push_back(is_own || !others_wrong ? whole.normals[v] : Vec3f{});
    part.values.push_back(is_own || !others_wrong ? whole.values[v] : 0);
  }
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    Triangle triangle = whole.triangles[t];
    bool all_there = true;
    for (std::int32_t& v : triangle) {
      v = number[static_cast<std::size_t>(v)];
      all_there = all_there && v >= 0;
    }
    if (!all_there) continue;
    part.triangles.push_back(triangle);
    part.cells.push_back(whole.cells[t]);
    part.segments.push_back(whole.segments[t]);
  }
  return part;
}

}  // namespace pointskin::test
