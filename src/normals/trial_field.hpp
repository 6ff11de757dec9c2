// Trial reconstructions: the unscreened Poisson field of the samples with some signs, again and again on one octree.
// Source: Hou, Wang, Wang, Qin, Qian & He, "Iterative Poisson surface reconstruction (iPSR) for unoriented points", ACM
// TOG 41(4), 2022. Differs: lines of normals are estimated once and only signs are iterated; the field's gradient at
// the samples takes the place of the faces near them; the field is 0 on the cube, so that a sample on the right side of
// a closed surface is at 1/2 and one on the wrong side at -1/2.
#pragma once

#include <cmath>
#include <utility>

#include "exec/algorithms.hpp"
#include "field/field_view.hpp"
#include "octree/access.hpp"
#include "octree/octree_data.hpp"
#include "poisson/boundary.hpp"
#include "poisson/density.hpp"
#include "poisson/divergence.hpp"
#include "poisson/resolution.hpp"
#include "poisson/screening.hpp"
#include "poisson/solve.hpp"

namespace pointskin::normals {
namespace trial {

/// Signed normals of the samples that take part.
struct SignNormals {
  ArrayView<const Vec3f> lines;
  ArrayView<const std::int32_t> signs;  // 0: left out
  ArrayView<Vec3f> out;
  PSK_HD void operator()(std::int64_t i) const {
    const auto s = static_cast<float>(signs[i]);
    const Vec3f n = lines[i];
    out[i] = {s * n.x, s * n.y, s * n.z};
  }
};

}  // namespace trial

/// The field at a sample.
struct AtSample {
  float value = 0;
  Vec3f outward{};  ///< minus the gradient, per finest cell
};

/// What kernels need to look at the field.
struct TrialView {
  field::FieldView field;

  [[nodiscard]] PSK_HD AtSample operator()(const Vec3f& p) const {
    const octree::OctreeView& tree = field.tree;
    const std::uint64_t key = octree::point_key(p.x, p.y, p.z);
    const octree::Leaf leaf = octree::locate(tree, key, tree.depth);
    const octree::LevelView& level = tree.levels[leaf.depth];
    const Vec3f local = octree::local_in_cell(p, octree::decode(octree::cell_key(key, leaf.depth)), leaf.depth);
    AtSample at;
    for (int s = 0; s < 8; ++s) {
      const std::int32_t corner = level.neighbour(leaf.cell, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
      const float weight = octree::corner_weight(s, local);
      const Vec3f g = field::gradient_at(field, leaf.depth, corner);
      at.value += weight * field.value(leaf.depth, corner);
      at.outward = {at.outward.x - weight * g.x, at.outward.y - weight * g.y, at.outward.z - weight * g.z};
    }
    const float scale = 1.0F / static_cast<float>(1 << (tree.depth - leaf.depth));
    at.outward = {scale * at.outward.x, scale * at.outward.y, scale * at.outward.z};
    return at;
  }
};

/// All that does not depend on the signs is made once.
template <exec::Space Exec>
class TrialField {
 public:
  /// @param positions  in the unit cube and the order of the tree's keys; kept
  /// @param lines      unit length
  TrialField(Exec& ex, const octree::OctreeData& tree, ArrayView<const Vec3f> positions, ArrayView<const Vec3f> lines)
      : ex_(ex), tree_(tree), lines_(lines) {
    samples_.positions = exec::make_buffer<Vec3f>(ex, positions.size);
    copy(ex, positions, samples_.positions.view());
    samples_.normals = exec::make_buffer<Vec3f>(ex, positions.size);
    copy(ex, lines, samples_.normals.view());
    poisson::weigh_samples(ex, tree, {1.5, false, false}, samples_);
    resolution_ = poisson::find_resolution(ex, tree, samples_);
    free_ = poisson::free_unknowns(ex, resolution_.view(tree), true);
  }

  /// @param signs  shape (n), 1, -1, or 0 for samples that are left out
  void solve(ArrayView<const std::int32_t> signs) {
    values_.reset();
    for_each(ex_, "normals.sign", signs.size, trial::SignNormals{lines_, signs, samples_.normals.view()});
    const exec::Buffer<float> divergence = poisson::splat_divergence(ex_, tree_, samples_.view(), resolution_);
    poisson::SolveOptions options{0, 8, false};
    options.free_unknowns = free_.cview();
    values_ = std::move(
        poisson::solve_poisson(ex_, resolution_.view(tree_), divergence.cview(), poisson::Screening{}, options).u);
  }

  /// Of the last solve.
  [[nodiscard]] TrialView view() const {
    return {{resolution_.view(tree_), values_.data(), 0, false, resolution_.bricks.data()}};
  }
  [[nodiscard]] ArrayView<const float> areas() const { return samples_.areas.cview(); }
  [[nodiscard]] ArrayView<const Vec3f> positions() const { return samples_.positions.cview(); }

 private:
  Exec& ex_;
  const octree::OctreeData& tree_;
  ArrayView<const Vec3f> lines_;
  poisson::Samples samples_;
  poisson::Resolution resolution_;
  exec::Buffer<std::uint8_t> free_;
  exec::Buffer<float> values_;
};

}  // namespace pointskin::normals
