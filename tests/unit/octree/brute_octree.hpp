// Clouds that are hard on an octree, and the octree of a cloud by definition: sets of integer coordinates.
#pragma once

#include <pointskin/vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/shapes.hpp"
#include "support/spaces.hpp"

namespace pointskin::test {

/// Integer coordinates of a cell or brick; independent of octree::Coordinates.
using Cell = std::array<std::int32_t, 3>;

/// Interleaved bits, x highest, bit by bit.
inline std::uint64_t morton(const Cell& c) {
  std::uint64_t key = 0;
  for (int bit = 20; bit >= 0; --bit)
    for (const std::int32_t v : c) key = key << 1 | (static_cast<std::uint64_t>(v) >> bit & 1);
  return key;
}

/// Cell of level `depth` that holds a point; the outermost ones hold what is on or beyond the cube's faces. Exact.
inline Cell cell_of(const Vec3f& p, int depth) {
  const double cells = std::ldexp(1.0, depth);
  const auto axis = [&](float v) {
    return static_cast<std::int32_t>(std::clamp(std::floor(static_cast<double>(v) * cells), 0.0, cells - 1));
  };
  return {axis(p.x), axis(p.y), axis(p.z)};
}

inline Cell half(const Cell& c) { return {c[0] >> 1, c[1] >> 1, c[2] >> 1}; }
inline Cell sum(const Cell& a, const Cell& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

/// The cells of the octree that build_octree's comment defines.
class BruteOctree {
 public:
  BruteOctree(const std::vector<Vec3f>& points, int depth) : bricks_(static_cast<std::size_t>(depth) + 1) {
    bricks_[0].insert(Cell{});
    std::set<Cell> inner;  // cells to surround: with points, then those with children
    for (const Vec3f& p : points) inner.insert(cell_of(p, depth));
    for (int d = depth; d > 0; --d) {
      std::set<Cell>& bricks = bricks_[static_cast<std::size_t>(d)];
      if (d <= 5)
        add_all(d, bricks);
      else
        for (const Cell& c : inner) add_around(c, d, bricks);
      inner = bricks;  // a brick's coordinates are those of its parent cell
    }
  }

  /// Brick coordinates of level d.
  const std::set<Cell>& bricks(int d) const { return bricks_[static_cast<std::size_t>(d)]; }
  bool is_cell(int d, const Cell& c) const {
    const std::int32_t end = 1 << d;
    for (const std::int32_t v : c)
      if (v < 0 || v >= end) return false;
    return bricks(d).count(half(c)) > 0;
  }
  /// Level of the deepest cell that holds p, no finer than `last`.
  int leaf_depth(const Vec3f& p, int last) const {
    while (!is_cell(last, cell_of(p, last))) --last;
    return last;
  }

 private:
  static void add_all(int d, std::set<Cell>& bricks) {
    const std::int32_t end = 1 << (d - 1);
    for (std::int32_t x = 0; x < end; ++x)
      for (std::int32_t y = 0; y < end; ++y)
        for (std::int32_t z = 0; z < end; ++z) bricks.insert({x, y, z});
  }
  static void add_around(const Cell& c, int d, std::set<Cell>& bricks) {
    const std::int32_t end = 1 << d;
    for (int j = 0; j < 27; ++j) {
      const Cell n = sum(c, {j / 9 - 1, j / 3 % 3 - 1, j % 3 - 1});
      if (std::all_of(n.begin(), n.end(), [&](std::int32_t v) { return v >= 0 && v < end; })) bricks.insert(half(n));
    }
  }

  std::vector<std::set<Cell>> bricks_;
};

struct TestCloud {
  std::string name;
  std::vector<Vec3f> points;
};

template <class Make>
std::vector<Vec3f> generate(int n, const Make& make) {
  std::vector<Vec3f> points;
  for (int i = 0; i < n; ++i) points.push_back(make());
  return points;
}

/// All points whose coordinates are 0, 1/2 or 1, and random ones on the faces.
inline std::vector<Vec3f> points_on_the_border(Random& random) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 27; ++i)
    points.push_back(
        {0.5F * static_cast<float>(i / 9), 0.5F * static_cast<float>(i / 3 % 3), 0.5F * static_cast<float>(i % 3)});
  for (int i = 0; i < 60; ++i) {
    float c[3];
    for (float& v : c) v = static_cast<float>(random.unit());
    c[i % 3] = i % 2 == 0 ? 0.0F : 1.0F;
    points.push_back({c[0], c[1], c[2]});
  }
  return points;
}

/// Clouds of so few places that 20 levels stay small.
inline std::vector<TestCloud> sparse_clouds(std::uint64_t seed) {
  Random random(seed);
  const auto anywhere = [&] {
    return Vec3f{static_cast<float>(random.unit()), static_cast<float>(random.unit()),
                 static_cast<float>(random.unit())};
  };
  const Vec3f one = anywhere();
  return {{"no point", {}},
          {"one point", {one}},
          {"one point 1000 times", std::vector<Vec3f>(1000, one)},
          {"two far points", {{0.01F, 0.02F, 0.03F}, {0.99F, 0.97F, 0.98F}}},
          {"two ends of a diagonal", {{0, 0, 0}, {1, 1, 1}}}};
}

inline std::vector<TestCloud> all_clouds(std::uint64_t seed) {
  Random random(hash(seed));
  const auto in = [&](double lower, double upper) { return static_cast<float>(random.in(lower, upper)); };
  std::vector<TestCloud> clouds = sparse_clouds(seed);
  clouds.push_back({"random", generate(200, [&] { return Vec3f{in(0, 1), in(0, 1), in(0, 1)}; })});
  clouds.push_back({"plane", generate(300, [&] { return Vec3f{in(0.2, 0.8), in(0.2, 0.8), 0.375F}; })});
  clouds.push_back({"cluster", generate(300, [&] { return Vec3f{in(0.7, 0.702), in(0.3, 0.302), in(0.5, 0.502)}; })});
  clouds.push_back({"on the border", points_on_the_border(random)});
  const std::vector<Vec3f> places = generate(40, [&] { return Vec3f{in(0, 1), in(0, 1), in(0, 1)}; });
  clouds.push_back(
      {"many duplicates", generate(600, [&] { return places[static_cast<std::size_t>(random.below(40))]; })});
  return clouds;
}

/// The same in another order (Fisher & Yates).
template <class T>
std::vector<T> reordered(std::vector<T> items, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[static_cast<std::size_t>(random.below(static_cast<std::int64_t>(i)))]);
  return items;
}

}  // namespace pointskin::test
