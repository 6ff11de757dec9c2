#include "fluid/band.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/bits.hpp"
#include "exec/atomic.hpp"
#include "exec/this_space.hpp"
#include "fluid/anisotropic.hpp"
#include "fluid/band_bricks.hpp"
#include "fluid/zhu_bridson.hpp"
#include "octree/brick_links.hpp"
#include "octree/brick_sets.hpp"

namespace pointskin::fluid {
namespace {

void check_bricks(std::int64_t bricks) {
  if (bricks > std::numeric_limits<std::int32_t>::max() / 8)
    throw Error(ErrorCode::over_limit, "the surface needs " + std::to_string(bricks) +
                                           " bricks of cells, more than 32-bit ids reach; choose larger cells");
}

template <exec::Space Exec>
SparseLevel mark_coarse(Exec& ex, const ReachOfParticle& reach_of, std::int64_t words) {
  constexpr const char* kLabel = "fluid.coarse";
  const std::int64_t n = reach_of.centres.size;
  SparseLevel level;
  level.depth = reach_of.depth;
  auto bits = exec::make_buffer<std::uint32_t>(ex, words);
  exec::fill(ex, bits.view(), 0U);
  for_each(ex, kLabel, n, MarkReach{reach_of, {bits.data()}});
  auto before = exec::make_buffer<std::int32_t>(ex, words + 1);
  for_each(ex, kLabel, words + 1, octree::build::CountWord{bits.cview(), before.view()});
  exclusive_scan(ex, kLabel, before.cview(), before.view());
  const std::int64_t bricks = exec::read_element(ex, before.cview(), words);
  check_bricks(bricks);
  level.brick_key = exec::make_buffer<std::uint64_t>(ex, bricks);
  using octree::build::BrickBits;
  for_each(ex, kLabel, words,
           octree::build::ListKeys<BrickBits>{{bits.data()}, before.data(), 0, level.brick_key.view()});
  level.neighbours = exec::make_buffer<std::int32_t>(ex, octree::kNeighbours * bricks);
  for_each(
      ex, kLabel, level.neighbours.size(),
      FindBrickNeighbour{level.depth, {bits.data(), before.data(), level.brick_key.cview()}, level.neighbours.view()});
  return level;
}

template <exec::Space Exec>
SparseLevel sort_coarse(Exec& ex, const ReachOfParticle& reach_of) {
  constexpr const char* kLabel = "fluid.coarse";
  const std::int64_t n = reach_of.centres.size;
  SparseLevel level;
  level.depth = reach_of.depth;
  auto counts = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, kLabel, n, CountReach{reach_of, counts.view()});
  const std::int64_t total = exec::sum_counts(ex, kLabel, counts.cview());
  check_bricks(total);
  auto first = exec::make_buffer<std::int32_t>(ex, n + 1);
  exclusive_scan(ex, kLabel, counts.cview(), first.view());
  auto keys = exec::make_buffer<std::uint64_t>(ex, total);
  for_each(ex, kLabel, n, ListReach{reach_of, first.cview(), keys.view()});
  level.brick_key = exec::sort_unique(ex, kLabel, std::move(keys), 3 * (level.depth - 1));
  level.neighbours = exec::make_buffer<std::int32_t>(ex, octree::kNeighbours * level.bricks());
  for_each(ex, kLabel, level.neighbours.size(),
           FindBrickNeighbour{level.depth, {nullptr, nullptr, level.brick_key.cview()}, level.neighbours.view()});
  return level;
}

/// Where values that are known already come from.
struct KnownValues {
  const std::int32_t* brick = nullptr;  // (coarse nodes) brick that they were in, or -1
  const float* values = nullptr;
};

/// A field that ends at walls.
template <class Field>
struct WalledField {
  Field field;
  Walls walls;
};

template <class Field>
struct Evaluate {
  Field field;
  Walls walls;
  int depth;
  const std::uint64_t* brick_key;
  const std::int32_t* parent;  // (bricks) coarse node, where values are known
  KnownValues known;
  float* values;

  [[nodiscard]] PSK_HD std::int64_t known_brick(std::int64_t brick) const {
    return known.brick == nullptr ? -1 : known.brick[parent[brick]];
  }
};

/// A corner a thread.
template <class Field>
struct EvaluateNode : Evaluate<Field> {
  PSK_HD void operator()(std::int64_t n) const {
    const std::int64_t before = this->known_brick(n >> 3);
    if (before >= 0) {
      this->values[n] = this->known.values[8 * before + (n & 7)];
      return;
    }
    const octree::Coordinates c = octree::decode(this->brick_key[n >> 3] << 3 | static_cast<unsigned>(n & 7));
    const float width = 1.0F / static_cast<float>(1 << this->depth);
    const Vec3f x{static_cast<float>(c.x) * width, static_cast<float>(c.y) * width, static_cast<float>(c.z) * width};
    this->values[n] = this->walls.cut(this->field.at(x), x);
  }
};

/// A brick at a time: its corners have the same particles around them.
template <class Field>
struct EvaluateBrick : Evaluate<Field> {
  PSK_HD void operator()(std::int64_t b) const {
    const EvaluateNode<Field> node{*this};
    for (int s = 0; s < 8; ++s) node(8 * b + s);
  }
#if PSK_WIDE
  void wide(std::int64_t b) const {
    const std::int64_t before = this->known_brick(b);
    if (before >= 0) {
      for (int s = 0; s < 8; ++s) this->values[8 * b + s] = this->known.values[8 * before + s];
      return;
    }
    const octree::Coordinates c = octree::decode(this->brick_key[b] << 3);
    const float width = 1.0F / static_cast<float>(1 << this->depth);
    const auto at = [width](std::int32_t v) { return static_cast<float>(v) * width; };
    float* const out = this->values + 8 * b;
    this->field.at_brick({at(c.x), at(c.y), at(c.z)}, width, out);
    if (this->walls.cells == 0) return;
    for (int s = 0; s < 8; ++s)
      out[s] = this->walls.cut(out[s],
                               {at(c.x + octree::slot_x(s)), at(c.y + octree::slot_y(s)), at(c.z + octree::slot_z(s))});
  }
#endif
};

template <exec::Space Exec, class Field>
void evaluate(Exec& ex, const WalledField<Field>& field, SparseLevel& level, const std::int32_t* parent,
              const KnownValues& known) {
  constexpr const char* label = "fluid.values";
  level.values = exec::make_buffer<float>(ex, 8 * level.bricks());
  const Evaluate<Field> work{field.field, field.walls, level.depth,        level.brick_key.data(),
                             parent,      known,       level.values.data()};
  if constexpr (Exec::kManyThreads)
    for_each(ex, label, 8 * level.bricks(), EvaluateNode<Field>{work});
  else
    for_each(ex, label, level.bricks(), EvaluateBrick<Field>{work});
}

/// A set of nodes of the coarse level.
struct NodeBits {
  std::uint32_t* words;
  PSK_HD void insert(std::int32_t node) const { exec::set_bits(words + node / 32, 1U << (node % 32)); }
  [[nodiscard]] PSK_HD bool contains(std::int32_t node) const {
    return node >= 0 && (words[node / 32] >> (node % 32) & 1) != 0;
  }
};

/// True if all corners of a cell exist, which is so for every cell that a particle that marks bricks reaches.
PSK_HD bool has_corners(const octree::LevelView& level, std::int32_t node) {
  for (int s = 0; s < 8; ++s)
    if (level.neighbour(node, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s)) < 0) return false;
  return true;
}

/// Cells that the surface passes through, or may.
struct MarkCrossed {
  octree::LevelView coarse;
  const float* values;
  float doubt;
  NodeBits crossed;
  PSK_HD void operator()(std::int64_t i) const {
    const auto node = static_cast<std::int32_t>(i);
    bool inside = false;
    bool outside = false;
    bool near = false;
    for (int s = 0; s < 8; ++s) {
      const std::int32_t corner = coarse.neighbour(node, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
      if (corner < 0) return;
      const float value = values[corner];
      inside = inside || value >= 0;
      outside = outside || value < 0;
      near = near || (value < doubt && value > -doubt);
    }
    if ((inside && outside) || near) crossed.insert(node);
  }
};

/// The cells in which particles lie, if all corners are outside: a drop may lie between them.
struct MarkDrops {
  octree::LevelView coarse;
  const float* values;
  ParticleTreeView tree;
  ArrayView<const std::uint8_t> deep;  // empty: none is
  ArrayView<const Vec3f> centres;
  Walls walls;
  NodeBits crossed;
  PSK_HD void operator()(std::int64_t i) const {
    if (!deep.empty() && deep[tree.cell[i]] != 0) return;
    const Vec3f p = centres[i];
    if (walls.depth(p) < 0) return;
    const std::uint64_t key = octree::cell_key(octree::point_key(p.x, p.y, p.z), coarse.depth);
    const auto node =
        static_cast<std::int32_t>(octree::find_node({coarse.brick_key, std::int64_t{coarse.bricks}}, key));
    for (int s = 0; s < 8; ++s) {
      const std::int32_t corner = coarse.neighbour(node, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
      if (corner < 0 || values[corner] >= 0) return;
    }
    crossed.insert(node);
  }
};

/// Bricks that hold cells of the band, or corners of them.
struct IsNeeded {
  octree::LevelView coarse;
  NodeBits crossed;
  PSK_HD bool operator()(std::int64_t i) const {
    const auto node = static_cast<std::int32_t>(i);
    for (int s = 0; s < 8; ++s)
      if (crossed.contains(coarse.neighbour(node, -octree::slot_x(s), -octree::slot_y(s), -octree::slot_z(s))))
        return true;
    return false;
  }
};

struct ListBricks {
  octree::LevelView coarse;
  NodeBits crossed;
  ArrayView<const std::int32_t> parent;
  ArrayView<std::uint64_t> brick_key;
  ArrayView<std::int32_t> child_brick;
  ArrayView<std::uint8_t> counts;
  PSK_HD void operator()(std::int64_t b) const {
    const std::int32_t node = parent[b];
    brick_key[b] = coarse.node_key(node);
    child_brick[node] = static_cast<std::int32_t>(b);
    counts[b] = crossed.contains(node) ? 1 : 0;
  }
};

constexpr std::uint32_t kSomeMissing = 1;
constexpr std::uint32_t kBeyond = 2;  // a brick is missing where the coarse level has no cell

/// Bricks beyond the faces through which the surface leaves the band.
struct MarkMissing {
  octree::LevelView fine, coarse;
  const float* values;
  ArrayView<const std::int32_t> parent;
  ArrayView<const std::uint8_t> counts;
  NodeBits crossed, missing;
  std::uint32_t* status;

  PSK_HD void operator()(std::int64_t b) const {
    if (counts[b] == 0) return;
    std::uint32_t inside = 0;  // over the 3 x 3 x 3 corners, x slowest
    const auto first = static_cast<std::int32_t>(8 * b);
    for (int i = 0; i < 27; ++i) {
      const std::int32_t corner = fine.neighbour(first, i / 9, i / 3 % 3, i % 3);
      if (values[corner] >= 0) inside |= 1U << i;
    }
    constexpr std::uint32_t kAll = (1U << 27) - 1;
    if (inside == 0 || inside == kAll) return;
    for (int face = 0; face < 6; ++face) {
      const std::uint32_t corners = corners_of(face / 2) << (face % 2 == 0 ? 0 : 2 * step(face / 2));
      if ((inside & corners) == 0 || (inside & corners) == corners) continue;
      const int d = face % 2 == 0 ? -1 : 1;
      const std::int32_t beyond =
          coarse.neighbour(parent[b], face / 2 == 0 ? d : 0, face / 2 == 1 ? d : 0, face / 2 == 2 ? d : 0);
      if (crossed.contains(beyond)) continue;
      const bool is_there = beyond >= 0 && has_corners(coarse, beyond);
      if (is_there) missing.insert(beyond);
      exec::set_bits(status, is_there ? kSomeMissing : kBeyond);
    }
  }

  PSK_HD static constexpr int step(int axis) { return axis == 0 ? 9 : axis == 1 ? 3 : 1; }
  /// The 9 corners of the lower face across an axis.
  PSK_HD static constexpr std::uint32_t corners_of(int axis) {
    std::uint32_t corners = 0;
    for (int i = 0; i < 27; ++i)
      if (i / step(axis) % 3 == 0) corners |= 1U << i;
    return corners;
  }
};

struct Join {
  ArrayView<const std::uint32_t> from;
  ArrayView<std::uint32_t> to;
  PSK_HD void operator()(std::int64_t i) const { to[i] |= from[i]; }
};

/// Bricks of the fine level from the crossed nodes of the coarse one.
struct FineBricks {
  exec::Buffer<std::int32_t> parent;       // (bricks)
  exec::Buffer<std::int32_t> child_brick;  // (coarse nodes)
};

template <exec::Space Exec>
FineBricks list_fine(Exec& ex, const SparseLevel& coarse, const NodeBits& crossed, Band& band) {
  constexpr const char* kLabel = "fluid.fine";
  const octree::LevelView above = coarse.view();
  FineBricks bricks;
  bricks.parent = select(ex, kLabel, above.nodes(), IsNeeded{above, crossed});
  check_bricks(bricks.parent.size());
  bricks.child_brick = exec::make_buffer<std::int32_t>(ex, above.nodes());
  exec::fill(ex, bricks.child_brick.view(), std::int32_t{-1});
  SparseLevel& fine = band.fine;
  fine.depth = coarse.depth + 1;
  fine.brick_key = exec::make_buffer<std::uint64_t>(ex, bricks.parent.size());
  band.counts = exec::make_buffer<std::uint8_t>(ex, bricks.parent.size());
  for_each(ex, kLabel, bricks.parent.size(),
           ListBricks{above, crossed, bricks.parent.cview(), fine.brick_key.view(), bricks.child_brick.view(),
                      band.counts.view()});
  fine.neighbours = exec::make_buffer<std::int32_t>(ex, octree::kNeighbours * fine.bricks());
  octree::LevelView linked = above;
  linked.child_brick = bricks.child_brick.data();
  const octree::FindNeighbours find{linked, bricks.parent.cview(), fine.neighbours.view()};
  if constexpr (Exec::kManyThreads)
    for_each(ex, kLabel, fine.neighbours.size(), octree::FindNeighbour{find});
  else
    for_each(ex, kLabel, fine.bricks(), octree::FindNeighboursOfBrick{find, octree::kNeighbourTables});
  return bricks;
}

/// The band, or false if the surface leaves the coarse level.
template <exec::Space Exec, class Field>
bool grow_band(Exec& ex, const WalledField<Field>& field, const ReachOfParticle& particles, const SparseLevel& coarse,
               float doubt, Band& band) {
  constexpr const char* kLabel = "fluid.crossed";
  const std::int64_t nodes = 8 * coarse.bricks();
  const std::int64_t words = (nodes + 31) / 32;
  auto bits = exec::make_buffer<std::uint32_t>(ex, 2 * words + 1);  // crossed, missing, the status
  exec::fill(ex, bits.view(), 0U);
  const NodeBits crossed{bits.data()};
  const NodeBits missing{bits.data() + words};
  std::uint32_t* const status = bits.data() + 2 * words;
  for_each(ex, kLabel, nodes, MarkCrossed{coarse.view(), coarse.values.data(), doubt, crossed});
  for_each(ex, kLabel, particles.centres.size,
           MarkDrops{coarse.view(), coarse.values.data(), particles.tree, particles.deep, particles.centres,
                     particles.walls, crossed});
  FineBricks known;
  exec::Buffer<float> known_values;
  for (band.rounds = 0;; ++band.rounds) {
    FineBricks bricks = list_fine(ex, coarse, crossed, band);
    evaluate(ex, field, band.fine, bricks.parent.data(), {known.child_brick.data(), known_values.data()});
    band.fine_corners = 8 * band.fine.bricks();
    for_each(ex, kLabel, band.fine.bricks(),
             MarkMissing{band.fine.view(), coarse.view(), band.fine.values.data(), bricks.parent.cview(),
                         band.counts.cview(), crossed, missing, status});
    const std::uint32_t found = exec::read_element(ex, bits.cview(), 2 * words);
    if ((found & kBeyond) != 0) return false;
    if (found == 0) return true;
    for_each(ex, kLabel, words, Join{bits.cview().part(words, words), bits.view().part(0, words)});
    exec::fill(ex, bits.view().part(words, words + 1), 0U);
    known = std::move(bricks);
    known_values = std::move(band.fine.values);
  }
}

}  // namespace

template <exec::Space Exec, class Field>
Band find_band(Exec& ex, const Field& field, const ParticleTreeView& tree, ArrayView<const Vec3f> centres,
               const BandOptions& options) {
  constexpr float kRounding = 1.001F;
  exec::Buffer<std::uint8_t> deep;
  // A cell may hold so many particles by rule that counts of a few say nothing.
  if (options.particles_per_cell >= 4) {
    deep = exec::make_buffer<std::uint8_t>(ex, std::int64_t{8} * tree.level.bricks);
    for_each(ex, "fluid.deep", deep.size(),
             FindDeep{tree.level, static_cast<std::int32_t>(0.85 * 27 * options.particles_per_cell), options.walls,
                      static_cast<float>(std::ldexp(tree.cube.size, -tree.level.depth)), deep.view()});
  }
  const WalledField<Field> walled{field, options.walls};
  for (;;) {
    const ReachOfParticle reach_of{tree,         deep.cview(), centres, options.depth - 1, kRounding * field.reach(),
                                   options.walls};
    const std::int64_t words = std::max<std::int64_t>(1, (std::int64_t{1} << 3 * (options.depth - 2)) / 32);
    constexpr std::int64_t kSmall = 1 << 16;
    constexpr std::int64_t kMostWordsPerParticle = 16;
    const bool few = options.depth - 2 <= 12 && words <= std::max(kSmall, kMostWordsPerParticle * centres.size);
    SparseLevel coarse = few ? mark_coarse(ex, reach_of, words) : sort_coarse(ex, reach_of);
    evaluate(ex, walled, coarse, nullptr, {});
    Band band;
    band.coarse_corners = 8 * coarse.bricks();
    if (grow_band(ex, walled, reach_of, coarse, options.doubt, band)) return band;
    if (deep.empty()) throw Error(ErrorCode::internal, "the surface lies beyond the reach of all particles");
    deep.reset();  // it was not as deep as it looked
  }
}

PSK_INSTANTIATE(find_band, ZhuBridsonField);
PSK_INSTANTIATE(find_band, AnisotropicField);

}  // namespace pointskin::fluid
