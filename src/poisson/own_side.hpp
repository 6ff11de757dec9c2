// What a sample stands for on its own side. Where two sheets are near each other, as in a thin wall, the density around
// a sample counts the samples of both, and both sheets get the area of the mean: if one was seen better than the other,
// the better one acts too strongly, and the field outside of the wall leaves 0 by the difference.
#pragma once

#include "core/host_device.hpp"
#include "octree/access.hpp"
#include "octree/view.hpp"
#include "poisson/bend.hpp"
#include "poisson/density.hpp"

namespace pointskin::poisson {

/// Samples on a sample's own side, on a face of a cell, below which an estimate is taken from a coarser level.
inline constexpr float kReliableOnSide = 6;

/// The least share of the samples around that is taken for those on the own side: a flipped normal has
/// hardly any, and many of them must not outweigh the others.
inline constexpr float kLeastOwnShare = 0.5F;

/// A sample whose own side has less than this share of the samples around disagrees with them: the mean cosine between its
/// normal and theirs is below 1/2.
inline constexpr float kAgreeingShare = 0.75F;

/// What samples add up to at a corner: their number and their normals, each by its hat. 16 bytes, read at once.
struct alignas(16) Facing {
  Vec3f normal;
  float count = 0;

  PSK_HD Facing& operator+=(const Facing& other) {
    normal += other.normal;
    count += other.count;
    return *this;
  }
  PSK_HD friend Facing operator*(const Facing& a, float s) { return {s * a.normal, s * a.count}; }
  PSK_HD friend Facing operator*(float s, const Facing& a) { return a * s; }
};

/// What one sample adds.
struct FacingOf {
  using Value = Facing;
  ArrayView<const Vec3f> normals;  // unit length, or zero
  PSK_HD Facing operator()(std::int32_t i) const { return {normals[i], 1}; }
};

/// Densities from the sums of Facing, over the nodes of levels 0..depth.
struct FacingView {
  octree::OctreeView tree;
  int depth = 0;
  const Facing* sums = nullptr;

  /// Samples per finest cell face at a sample p with unit normal n: all, as DensityView::samples_per_cell has it, and those
  /// on its own side. A sample q counts with (1 + n_p . n_q) / 2 there, so with the number N and the normals F of a level
  ///   own_p = max(kLeastOwnShare N(p), (N(p) + n_p . F(p)) / 2) / kPlaneFactor,
  /// on the finest level where that is at least kReliableOnSide. Of one sheet it is the density; across an edge the other
  /// face counts half. Of a sample without a normal all count.
  struct Densities {
    float all = 0, own_side = 0;
    bool disagrees = false;  ///< with the samples around, on the level of `all`
  };
  PSK_HD Densities at(const Vec3f& p, const Vec3f& n) const {
    int level = octree::locate(tree, octree::point_key(p.x, p.y, p.z), depth).depth;
    Densities found;
    bool has_all = false;
    bool has_own = false;
    for (;; --level) {
      const Facing sum = octree::value_at(tree, sums, p, level);
      const float all = sum.count * (1 / kPlaneFactor);
      const float per_finest = 1 / static_cast<float>(std::int64_t{1} << 2 * (tree.depth - level));
      const bool last = level == 0;
      if (!has_all && (last || all >= kReliableSamples)) {
        found.all = all * per_finest;
        found.disagrees = n != Vec3f{} && side(sum, n, all) < kAgreeingShare * all;
        has_all = true;
      }
      const float own = on_own_side(sum, n, all);
      if (!has_own && (last || own >= kReliableOnSide)) {
        found.own_side = own * per_finest;
        has_own = true;
      }
      if (has_all && has_own) return found;
    }
  }

  /// How much the surface bends around a point, from the levels `from` and above.
  PSK_HD float bend_at(const Vec3f& p, int from) const {
    BendAcrossLevels bend;
    for (int level = from; level >= 0 && !bend.is_known(); --level) {
      const Facing sum = octree::value_at(tree, sums, p, level);
      if (sum.count > 0) bend.add(sum.normal, sum.count, sum.count * (1 / kPlaneFactor));
    }
    return bend.value();
  }

 private:
  PSK_HD static float side(const Facing& sum, const Vec3f& n, float all) {
    return 0.5F * (all + dot(n, sum.normal) * (1 / kPlaneFactor));
  }
  PSK_HD static float on_own_side(const Facing& sum, const Vec3f& n, float all) {
    if (n == Vec3f{}) return all;
    const float own = side(sum, n, all);
    const float least = kLeastOwnShare * all;
    return own > least ? own : least;
  }
};

}  // namespace pointskin::poisson
