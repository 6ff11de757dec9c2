// Cells of a grid that is halved and halved again hold more and more of the points alone. At the level where half as
// many cells are occupied as there are places, a cell is about 1.55 spacings wide: points thrown at random onto a
// surface of area A occupy that share when there are 1.6 to a cell, and a surface crosses about 1.5 A / s^2 cells of
// side s. Unlike distances to nearest neighbours, this is not led astray by points that come in pairs.
#include "render/point_spacing.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"
#include "octree/keys.hpp"

namespace pointskin::render_detail {
namespace {

constexpr int kLevels = 16;
constexpr double kSpacingsPerCell = 1.55;
constexpr std::uint64_t kNoPlace = std::uint64_t{1} << (3 * kLevels);

/// Morton key of a point in the finest grid over the cube about `centre`; kNoPlace outside.
std::uint64_t key_of(const Vec3f& p, const Vec3d& centre, double radius) {
  const Vec3d unit = 0.5 / radius * (to_double(p) - centre);
  constexpr double kCells = 1 << kLevels;
  std::array<std::int32_t, 3> cell{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double at = (unit[a] + 0.5) * kCells;
    if (!(at >= 0 && at <= kCells)) return kNoPlace;
    cell[a] = static_cast<std::int32_t>(std::min(at, kCells - 1));
  }
  return octree::encode({cell[0], cell[1], cell[2]});
}

/// occupied[l]: cells of level l, 2^l along an axis, that hold points.
std::array<std::int64_t, kLevels + 1> occupied_cells(const exec::Buffer<std::uint64_t>& keys) {
  std::array<std::int64_t, kLevels + 1> occupied{};
  if (keys.empty() || keys.data()[0] == kNoPlace) return occupied;
  occupied[0] = 1;
  for (std::int64_t i = 1; i < keys.size() && keys.data()[i] != kNoPlace; ++i) {
    const std::uint64_t change = keys.data()[i] ^ keys.data()[i - 1];
    if (change == 0) continue;
    const int highest = std::bit_width(change) - 1;
    ++occupied[static_cast<std::size_t>(kLevels - highest / 3)];  // the first level at which the two part
  }
  for (std::size_t l = 1; l < occupied.size(); ++l) occupied[l] += occupied[l - 1];
  return occupied;
}

}  // namespace

double point_spacing(exec::Cpu& ex, const std::vector<Vec3f>& positions, const Vec3d& centre, double radius) {
  if (positions.empty() || !(radius > 0)) return 0;
  exec::Buffer<std::uint64_t> keys(ex.pool(), static_cast<std::int64_t>(positions.size()));
  exec::for_each(ex, "spacing", keys.size(), [&](std::int64_t i) {
    keys.data()[i] = key_of(positions[static_cast<std::size_t>(i)], centre, radius);
  });
  exec::sort_keys(ex, "spacing", keys, 3 * kLevels + 1);
  const std::array<std::int64_t, kLevels + 1> occupied = occupied_cells(keys);
  if (occupied.back() < 2) return 0;
  const double half = static_cast<double>(occupied.back()) / 2;
  std::size_t l = 1;
  while (static_cast<double>(occupied[l]) < half) ++l;
  // Between two levels the number of cells grows by a power.
  const double below = std::log2(static_cast<double>(occupied[l - 1]));
  const double above = std::log2(static_cast<double>(occupied[l]));
  const double part = above > below ? std::clamp((std::log2(half) - below) / (above - below), 0.0, 1.0) : 1;
  const double level = static_cast<double>(l - 1) + part;
  return 2 * radius / std::exp2(level) / kSpacingsPerCell;
}

}  // namespace pointskin::render_detail
