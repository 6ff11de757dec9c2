#include "diagnose/look.hpp"

#include <algorithm>
#include <cmath>

#include "core/vec3.hpp"
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
  static constexpr int kLanes = 32;
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
    const std::int64_t n = samples.positions.size;
    const std::int64_t i = spread(s);
    for (int step = 1; step <= kFollowers && i + step < n; ++step) compare(i, i + step, tally);
    PSK_UNROLL
    for (int k = 0; k < kScatterSteps; ++k) {
      const std::int64_t other = i + (std::int64_t{1} << 2 * k);
      if (other < n) scatter(k, i, other, tally);
    }
    add_up(i, tally);
    if (s == 0 && samples.lonely != nullptr) tally.add(kLonely, *samples.lonely);
    const std::int64_t warp = s / ByLanes<LookAtSample>::kLanes;  // each does the same thing with all of its lanes
    if (warp % kSparse != 0)
      compare_across(i, static_cast<int>(s % 3), tally);
    else if (density.counts != nullptr)
      exec::add(counts->densities + DensityBin::of(density.samples_per_cell(tree, samples.positions[i])), 1);
  }

 private:
  /// With the first samples of the two cells beside that of sample i along an axis, cells that hold a few samples.
  PSK_HD void compare_across(std::int64_t i, int axis, Sums& tally) const {
    constexpr std::int32_t kFew = 4;
    const Vec3f p = samples.positions[i];
    octree::Leaf at = octree::locate(tree, octree::point_key(p.x, p.y, p.z), tree.depth);
    const auto held = [&](int depth, std::int32_t cell) {
      return tree.levels[depth].point_begin[cell + 1] - tree.levels[depth].point_begin[cell];
    };
    while (at.depth > 0 && held(at.depth, at.cell) < kFew)
      at = {at.depth - 1, tree.levels[at.depth].parent[at.cell >> 3]};
    const octree::LevelView& level = tree.levels[at.depth];
    for (int side = -1; side <= 1; side += 2) {
      const std::int32_t cell =
          level.neighbour(at.cell, axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0);
      if (level.is_cell(cell) && held(at.depth, cell) > 0) compare(i, level.point_begin[cell], tally);
    }
  }

  /// Opposed normals are those of two sheets, or one of them is flipped. Sheets lie at different heights along the
  /// normals; two samples of one surface do so by chance, as often this way as that.
  PSK_HD void compare(std::int64_t i, std::int64_t j, Sums& tally) const {
    constexpr double kAlikeCosine = 0.5;
    constexpr double kSteep = 0.35;  // across an edge, or from sheet to sheet
    const Vec3d n = to_double(samples.normals[i]);
    const Vec3d m = to_double(samples.normals[j]);
    const Vec3d d = to_double(samples.positions[j]) - to_double(samples.positions[i]);
    const double along_n = dot(n, d);
    const double along_m = dot(m, d);
    const double limit = kSteep * kSteep * dot(d, d);
    const bool are_neighbours = may_share_surface(i, j, dot(d, d));
    if (!are_neighbours || !(along_n * along_n < limit && along_m * along_m < limit)) return;
    const double cosine = dot(n, m);
    const bool opposed = cosine < -kAlikeCosine;
    const double behind = along_m - along_n;  // > 0: each lies behind the other
    tally.count(kAlike, cosine > kAlikeCosine);
    tally.count(kApart, opposed && behind > 0);
    tally.count(kFacing, opposed && behind < 0);
    tally.count(kAbreast, opposed && behind == 0);
  }

  /// Whether two samples are neighbours, as far as areas tell. Those without one are outliers, whose normals are random, or
  /// flipped ones of the surface, which lie as near to the next sample there as any: nearer than the width of kNear samples.
  /// Both areas are read before one is looked at: reads that wait for others take longer.
  [[nodiscard]] PSK_HD bool may_share_surface(std::int64_t i, std::int64_t j, double distance2) const {
    constexpr double kNear = 4;
    if (samples.areas.empty()) return true;
    const float area = samples.areas[i];
    const float other = samples.areas[j];
    if (area > 0 && other > 0) return true;
    const double cell = 1.0 / static_cast<double>(std::int64_t{1} << tree.depth);
    return distance2 < kNear * kNear * static_cast<double>(area > other ? area : other) * (cell * cell);
  }

  /// Half the squared distance across the surface, to which even curvature does not add (poisson/trust.hpp).
  PSK_HD void scatter(int k, std::int64_t i, std::int64_t j, Sums& tally) const {
    constexpr double kAgreement = 0.8;
    constexpr double kMost = 512;  // finest cells^2
    const Vec3d n = to_double(samples.normals[i]);
    const Vec3d m = to_double(samples.normals[j]);
    if (!(dot(n, m) > kAgreement)) return;
    const double across = 0.5 * static_cast<double>(std::int64_t{1} << tree.depth) *
                          dot(n + m, to_double(samples.positions[j]) - to_double(samples.positions[i]));
    const double half = 0.5 * across * across;
    tally.add_fraction(kScatter + k, half < kMost ? half : kMost);
    tally.add(kScatterPairs + k, 1);
  }

  /// What the sample adds to the area, the vector area and the volume that are enclosed.
  PSK_HD void add_up(std::int64_t i, Sums& tally) const {
    const double cell = 1.0 / static_cast<double>(std::int64_t{1} << tree.depth);
    const double stands_for = samples.areas.empty() ? 1.0 / static_cast<double>(samples.positions.size)
                                                    : static_cast<double>(samples.areas[i]) * cell * cell;
    const double area = stands_for < 1 ? stands_for : 1.0;
    const Vec3d n = to_double(samples.normals[i]) * area;
    tally.add_fraction(kArea, area);
    tally.add_fraction(kVectorX, n.x);
    tally.add_fraction(kVectorY, n.y);
    tally.add_fraction(kVectorZ, n.z);
    tally.add_fraction(kFlux, dot(n, to_double(samples.positions[i]) - Vec3d{0.5, 0.5, 0.5}));
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
      look_at_face(static_cast<int>(i), tally);
    else
      look_at_sample(spread(i - kAllFacePoints), tally);
  }

 private:
  PSK_HD void look_at_face(int i, Sums& tally) const {
    const int face = i / (kFacePoints * kFacePoints);
    const float u = (static_cast<float>(i % kFacePoints) + 0.5F) / kFacePoints;
    const float v = (static_cast<float>(i / kFacePoints % kFacePoints) + 0.5F) / kFacePoints;
    const float at = face % 2 == 0 ? 0.0F : 1.0F;
    const Vec3f p = face / 2 == 0 ? Vec3f{at, u, v} : face / 2 == 1 ? Vec3f{u, at, v} : Vec3f{u, v, at};
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

struct LookAtTriangle {
  using Sums = Tally<kSurface, kSums>;
  octree::OctreeView tree;
  int far_depth;
  ArrayView<const Vec3f> positions;
  ArrayView<const Triangle> triangles;
  Spread spread;

  PSK_HD void operator()(std::int64_t i, Sums& tally) const {
    const std::int32_t* v = triangles[spread(i)].data();
    const Vec3f a = positions[v[0]];
    const Vec3f b = positions[v[1]];
    const Vec3f c = positions[v[2]];
    const Vec3d normal = cross(to_double(b) - to_double(a), to_double(c) - to_double(a));
    const double area = 0.5 * std::sqrt(dot(normal, normal));
    tally.add_fraction(kSurface, area);
    if (is_far({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3}))
      tally.add_fraction(kFarSurface, area);
    if (is_cap(a.x, b.x, c.x) || is_cap(a.y, b.y, c.y) || is_cap(a.z, b.z, c.z)) tally.add_fraction(kCaps, area);
  }

 private:
  /// Vertices of caps lie 1/1000 of an edge, which is 1/16 at most, from a face (docs/algorithm.md, section 7).
  PSK_HD static bool is_cap(float a, float b, float c) {
    constexpr float kNear = 1e-4F;
    return (a < kNear && b < kNear && c < kNear) || (a > 1 - kNear && b > 1 - kNear && c > 1 - kNear);
  }

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
Counts read_counts(Exec& ex, const exec::Buffer<Counts>& counts) {
  Counts host;
  copy_to_host(ex, ArrayView<const std::uint64_t>(words_of(counts)), reinterpret_cast<std::uint64_t*>(&host));
  return host;
}

PSK_INSTANTIATE(make_counts);
PSK_INSTANTIATE(look_at_samples);
PSK_INSTANTIATE(look_at_field);
PSK_INSTANTIATE(look_at_surface);
PSK_INSTANTIATE(read_counts);

}  // namespace pointskin::diagnose
