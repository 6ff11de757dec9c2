#include "diagnose/look.hpp"

#include <algorithm>

#include "core/vec3.hpp"
#include "diagnose/in_blocks.hpp"
#include "diagnose/look_at.hpp"
#include "diagnose/spread.hpp"
#include "exec/this_space.hpp"
#include "octree/access.hpp"

namespace pointskin::diagnose {
namespace {

/// All counts are words, which threads set and copy side by side.
ArrayView<std::uint64_t> words_of(const exec::Buffer<Counts>& counts) {
  return {reinterpret_cast<std::uint64_t*>(counts.data()), sizeof(Counts) / sizeof(std::uint64_t)};
}

/// What looks at n things does to add up their tallies: a warp's are added at once.
template <class F>
struct ByLanes {
  static constexpr int kLanes = kWarp;
  using Sum = typename F::Sums;
  F f;
  std::int64_t n;
  Counts* counts;
  PSK_HD Sum part(std::int64_t group, int lane) const {
    Sum sum;
    if (group * kLanes + lane < n) f(group * kLanes + lane, sum);
    return sum;
  }
  PSK_HD void finish(std::int64_t, const Sum& sum) const { sum.flush(counts); }
};
template <exec::Space Exec, class F>
void look_at_each(Exec& ex, const char* label, std::int64_t n, const F& f, Counts* counts) {
  constexpr std::int64_t kLanes = ByLanes<F>::kLanes;
  for_each_by_lanes(ex, label, (n + kLanes - 1) / kLanes, ByLanes<F>{f, n, counts});
}

struct LookAtSample {
  using Sums = Tally<kAlike, kFacesInside>;
  octree::OctreeView tree;
  poisson::DensityView density;  // without counts where it is not known
  poisson::SamplesView samples;
  Spread spread;
  Counts* counts;

  PSK_HD void operator()(std::int64_t s, Sums& tally) const {
    const std::int64_t i = spread(s);
    pairs().look_at(i, tally);
    if (s == 0 && samples.lonely != nullptr) tally.add(kLonely, *samples.lonely);
    if (looks_across(s))
      compare_across(i, axis_across(s), tally);
    else if (density.counts != nullptr)
      exec::add(counts->densities + DensityBin::of(density.samples_per_cell(tree, samples.positions[i])), 1);
  }

 private:
  [[nodiscard]] PSK_HD LookAtPairs<poisson::SamplesView> pairs() const { return {samples, tree.depth}; }

  /// With the first samples of the two cells beside that of sample i along an axis, cells that hold a few samples.
  PSK_HD void compare_across(std::int64_t i, int axis, Sums& tally) const {
    const Vec3f p = samples.positions[i];
    octree::Leaf at = octree::locate(tree, octree::point_key(p.x, p.y, p.z), tree.depth);
    const auto held = [&](int depth, std::int32_t cell) {
      return tree.levels[depth].point_begin[cell + 1] - tree.levels[depth].point_begin[cell];
    };
    while (at.depth > 0 && held(at.depth, at.cell) < kFewSamples)
      at = {at.depth - 1, tree.levels[at.depth].parent[at.cell >> 3]};
    const octree::LevelView& level = tree.levels[at.depth];
    for (int side = -1; side <= 1; side += 2) {
      const std::int32_t cell =
          level.neighbour(at.cell, axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0);
      if (level.is_cell(cell) && held(at.depth, cell) > 0) pairs().compare(i, level.point_begin[cell], tally);
    }
  }
};

/// The trilinear function at a point: its value above the isovalue, and the length of its gradient per finest cell.
struct AtPoint {
  float above = 0, slope = 0;
};
PSK_HD AtPoint look_at(const field::FieldView& field, const Vec3f& p) {
  const std::uint64_t key = octree::point_key(p.x, p.y, p.z);
  const octree::Leaf leaf = octree::locate(field.tree, key, field.tree.depth);
  const octree::LevelView& level = field.tree.levels[leaf.depth];
  const Vec3f t = octree::local_in_cell(p, octree::decode(octree::cell_key(key, leaf.depth)), leaf.depth);
  float value = 0;
  Vec3f g{};
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    const int x = octree::slot_x(s);
    const int y = octree::slot_y(s);
    const int z = octree::slot_z(s);
    const float u = field.value(leaf.depth, level.neighbour(leaf.cell, x, y, z));
    const float wx = x != 0 ? t.x : 1 - t.x;
    const float wy = y != 0 ? t.y : 1 - t.y;
    const float wz = z != 0 ? t.z : 1 - t.z;
    value += wx * wy * wz * u;
    g = {g.x + (x != 0 ? u : -u) * wy * wz, g.y + (y != 0 ? u : -u) * wx * wz, g.z + (z != 0 ? u : -u) * wx * wy};
  }
  const auto finest = static_cast<float>(std::int64_t{1} << (field.tree.depth - leaf.depth));
  return {value - field.isovalue, length(g) / finest};
}

struct LookAtField {
  using Sums = Tally<kFacesInside, kSurface>;
  field::FieldView field;
  poisson::SamplesView samples;
  Spread spread;

  PSK_HD void operator()(std::int64_t i, Sums& tally) const {
    if (i < kAllFacePoints)
      look_at_face(face_point(static_cast<int>(i)), tally);
    else
      look_at_sample(spread(i - kAllFacePoints), tally);
  }

  [[nodiscard]] PSK_HD static Vec3f face_point(int i) {
    const int face = i / (kFacePoints * kFacePoints);
    const float u = (static_cast<float>(i % kFacePoints) + 0.5F) / kFacePoints;
    const float v = (static_cast<float>(i / kFacePoints % kFacePoints) + 0.5F) / kFacePoints;
    const float at = face % 2 == 0 ? 0.0F : 1.0F;
    return face / 2 == 0 ? Vec3f{at, u, v} : face / 2 == 1 ? Vec3f{u, at, v} : Vec3f{u, v, at};
  }

  PSK_HD void look_at_face(const Vec3f& p, Sums& tally) const {
    tally.count(kFacesInside, look_at(field, p).above >= 0);
  }

  /// A sample is off where the level set is farther than two cells of the level that carries its normal.
  PSK_HD void look_at_sample(std::int64_t i, Sums& tally) const {
    constexpr float kCells = 2;
    const int depth = samples.splat_depths.empty() ? field.tree.depth : static_cast<int>(samples.splat_depths[i]);
    const auto cell = static_cast<float>(std::int64_t{1} << (field.tree.depth - depth));
    const AtPoint at = look_at(field, samples.positions[i]);
    const float above = at.above < 0 ? -at.above : at.above;
    tally.add(kSamplesSeen, 1);
    tally.count(kSamplesOff, above > kCells * cell * at.slope);
  }
};

/// The same in a block: points of the faces that lie in its cells, and samples that were chosen already.
struct LookAtFieldOfBlock {
  using Sums = LookAtField::Sums;
  LookAtField look;
  std::uint64_t begin, end;

  PSK_HD void operator()(std::int64_t i, Sums& tally) const {
    if (i >= kAllFacePoints) return look.look_at_sample(i - kAllFacePoints, tally);
    const Vec3f p = LookAtField::face_point(static_cast<int>(i));
    const std::uint64_t cell = octree::cell_key(octree::point_key(p.x, p.y, p.z), look.field.tree.depth);
    if (cell >= begin && cell < end) look.look_at_face(p, tally);
  }
};

struct LookAtDensity {
  octree::OctreeView tree;
  poisson::DensityView density;
  ArrayView<const Vec3f> positions;
  Counts* counts;
  PSK_HD void operator()(std::int64_t i) const {
    exec::add(counts->densities + DensityBin::of(density.samples_per_cell(tree, positions[i])), 1);
  }
};

struct LookAtTriangle {
  using Sums = Tally<kSurface, kSums>;
  octree::OctreeView tree;
  int far_depth;
  ArrayView<const Vec3f> positions;
  ArrayView<const Triangle> triangles;
  Spread spread;

  PSK_HD void operator()(std::int64_t i, Sums& tally) const {
    const std::int32_t* v = triangles[spread(i)].data();
    look_at_triangle(
        positions[v[0]], positions[v[1]], positions[v[2]], [this](const Vec3f& p) { return is_far(p); }, tally);
  }

 private:
  PSK_HD bool is_far(const Vec3f& p) const {
    const octree::Leaf leaf = octree::locate(tree, octree::point_key(p.x, p.y, p.z), far_depth);
    if (leaf.depth < far_depth) return true;  // cells are where samples are, and around
    const octree::LevelView& level = tree.levels[far_depth];
    const auto is_occupied = [&](std::int32_t cell) {
      return level.is_cell(cell) && level.point_begin[cell] < level.point_begin[cell + 1];
    };
    if (is_occupied(leaf.cell)) return false;  // of most
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          if (is_occupied(level.neighbour(leaf.cell, dx, dy, dz))) return false;
    return true;
  }
};

}  // namespace

template <exec::Space Exec>
exec::Buffer<Counts> make_counts(Exec& ex) {
  auto counts = exec::make_buffer<Counts>(ex, 1);
  exec::fill(ex, words_of(counts), std::uint64_t{0});
  return counts;
}

template <exec::Space Exec>
void look_at_samples(Exec& ex, const octree::OctreeView& tree, const poisson::Density& density,
                     const poisson::SamplesView& samples, exec::Buffer<Counts>& counts) {
  const std::int64_t some = std::min(samples.positions.size, kSamples);
  look_at_each(
      ex, "look.samples", some,
      LookAtSample{
          tree, {density.depth, density.counts.data()}, samples, {some, samples.positions.size}, counts.data()},
      counts.data());
}

template <exec::Space Exec>
void look_at_field(Exec& ex, const field::FieldView& field, const poisson::SamplesView& samples,
                   exec::Buffer<Counts>& counts) {
  const std::int64_t some = std::min(samples.positions.size, kSamples / kSparse);
  look_at_each(ex, "look.field", kAllFacePoints + some, LookAtField{field, samples, {some, samples.positions.size}},
               counts.data());
}

template <exec::Space Exec>
void look_at_surface(Exec& ex, const octree::OctreeView& tree, int far_depth, const surface::Surface& surface,
                     const exec::Buffer<Counts>& counts) {
  const std::int64_t some = std::min(surface.triangles.size(), kTriangles);
  look_at_each(
      ex, "look.surface", some,
      LookAtTriangle{
          tree, far_depth, surface.positions.cview(), surface.triangles.cview(), {some, surface.triangles.size()}},
      counts.data());
}

template <exec::Space Exec>
void look_at_densities(Exec& ex, const octree::OctreeView& tree, const poisson::Density& density,
                       ArrayView<const Vec3f> positions, const exec::Buffer<Counts>& counts) {
  for_each(ex, "look.samples", positions.size,
           LookAtDensity{tree, {density.depth, density.counts.data()}, positions, counts.data()});
}

template <exec::Space Exec>
void look_at_field_of_block(Exec& ex, const field::FieldView& field, const poisson::SamplesView& samples,
                            std::uint64_t begin, std::uint64_t end, const exec::Buffer<Counts>& counts) {
  const std::int64_t n = samples.positions.size;
  look_at_each(ex, "look.field", kAllFacePoints + n, LookAtFieldOfBlock{{field, samples, {n, n}}, begin, end},
               counts.data());
}

template <exec::Space Exec>
Counts read_counts(Exec& ex, const exec::Buffer<Counts>& counts) {
  Counts host;
  copy_to_host(ex, ArrayView<const std::uint64_t>(words_of(counts)), reinterpret_cast<std::uint64_t*>(&host));
  return host;
}

PSK_INSTANTIATE(make_counts);
PSK_INSTANTIATE(look_at_samples);
PSK_INSTANTIATE(look_at_field);
PSK_INSTANTIATE(look_at_surface);
PSK_INSTANTIATE(look_at_densities);
PSK_INSTANTIATE(look_at_field_of_block);
PSK_INSTANTIATE(read_counts);

}  // namespace pointskin::diagnose
