// Which cells a surface of particles passes through, and the field's values at their corners.
//
// Two sparse levels of the octree, nothing above. The coarse one covers what lies near particles, except where the
// fluid is deep; its cells that change sign, or whose corners are so near the surface that it may pass between them,
// become bricks of the fine level. Then bricks are added until none is missing: where the surface leaves a brick
// through a face, the brick beyond is there. So its surface is that of a dense grid, for every component of which a
// cell was found, and always closed.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "fluid/particle_tree.hpp"
#include "fluid/walls.hpp"
#include "octree/view.hpp"

namespace pointskin::fluid {

/// A level of bricks, as in octree::LevelView, without parents and point ranges. In the space that it was made in.
struct SparseLevel {
  int depth = 0;
  exec::Buffer<std::uint64_t> brick_key;  ///< (bricks) ascending
  exec::Buffer<std::int32_t> neighbours;  ///< (bricks, 27)
  exec::Buffer<float> values;             ///< (8 bricks) at the corners; inside where >= 0

  [[nodiscard]] std::int64_t bricks() const { return brick_key.size(); }
  [[nodiscard]] octree::LevelView view() const;
};

/// The finest level around the surface.
struct Band {
  SparseLevel fine;
  exec::Buffer<std::uint8_t> counts;  ///< (bricks) 1: cells; 0: there for its corners only
  std::int64_t coarse_corners = 0;    ///< evaluated on the coarse level
  std::int64_t fine_corners = 0;      ///< evaluated on the fine level
  int rounds = 0;                     ///< of adding bricks that were missing

  /// For surface::extract_surface: an octree that has its finest level alone.
  [[nodiscard]] field::FieldView field() const;
};

struct BandOptions {
  int depth = 4;        ///< of the finest cells, in [3, octree::kMaxDepth]
  float doubt = 0.75F;  ///< values of smaller magnitude on the coarse level are near the surface; finest cells
  double particles_per_cell = 8;  ///< of the tree's cells, in the bulk; cells are deep by their count
  Walls walls{};                  ///< where the field ends; `centres` beyond them count for it and nothing else
};

/// Finds the band of `field` (fluid/zhu_bridson.hpp, fluid/anisotropic.hpp).
/// @param tree       of `centres`, over the unit cube
/// @param centres    shape (n) in the order of its keys, unit cube; nothing farther than field.reach() from all is
/// inside O(n + corners near the surface); four host round trips, two more for every round. The same bits on every
/// device.
/// @throws Error over_limit if memory or 32-bit ids run out
template <exec::Space Exec, class Field>
Band find_band(Exec& ex, const Field& field, const ParticleTreeView& tree, ArrayView<const Vec3f> centres,
               const BandOptions& options);

}  // namespace pointskin::fluid
