#include "boolean/crease.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "boolean/crease_kernels.hpp"
#include "boolean/set_operation.hpp"
#include "exec/this_space.hpp"

namespace pointskin::boolean {
namespace {

/// Steps of Newton's method: distances are good to first order, so a few suffice.
constexpr int kSteps = 6;

/// Rows of samples, distances from the curve in leaves.
constexpr int kRows = 2;
PSK_HD constexpr float row_offset(int row) { return row == 0 ? 0.35F : 1.0F; }

/// A leaf that the surface passes through.
struct IsCrossedLeaf {
  field::FieldView f;
  PSK_HD bool operator()(std::int64_t index) const {
    const int level = f.tree.level_of(index);
    const octree::LevelView& l = f.tree.levels[level];
    const auto node = static_cast<std::int32_t>(index - l.first_node);
    if (!f.is_cell(level, node) || f.is_split(level, node)) return false;
    int inside = 0;
    for (int s = 0; s < 8; ++s) {
      const std::int32_t corner = l.neighbour(node, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
      inside += f.value(level, corner) >= f.isovalue ? 1 : 0;
    }
    return inside > 0 && inside < 8;
  }
};

/// Middles and widths of cubes.
struct Cubes {
  exec::Buffer<Vec3f> middles;  // unit cube
  exec::Buffer<float> widths;   // finest cells

  [[nodiscard]] std::int64_t size() const { return middles.size(); }
};
template <exec::Space Exec>
Cubes make_cubes(Exec& ex, std::int64_t n) {
  return {exec::make_buffer<Vec3f>(ex, n), exec::make_buffer<float>(ex, n)};
}

struct LeafCube {
  octree::OctreeView tree;
  ArrayView<const std::int32_t> leaves;
  ArrayView<Vec3f> middles;
  ArrayView<float> widths;
  PSK_HD void operator()(std::int64_t i) const {
    const int level = tree.level_of(leaves[i]);
    const octree::LevelView& l = tree.levels[level];
    const octree::Coordinates c = octree::decode(l.node_key(static_cast<std::int32_t>(leaves[i] - l.first_node)));
    const float half = 0.5F / static_cast<float>(1 << level);
    middles[i] = {static_cast<float>(2 * c.x + 1) * half, static_cast<float>(2 * c.y + 1) * half,
                  static_cast<float>(2 * c.z + 1) * half};
    widths[i] = static_cast<float>(1 << (tree.depth - level));
  }
};

/// True if the surface may pass through a cube: half its diagonal, and as much again for distances of first order.
struct MayCross {
  ArrayView<const SurfaceDistance> to_surface;
  ArrayView<const float> widths;
  PSK_HD bool operator()(std::int64_t i) const { return size_of(to_surface[i].cells) <= 1.75F * widths[i]; }
};

/// The eighths of cubes.
struct Split {
  ArrayView<const std::int32_t> chosen;
  ArrayView<const Vec3f> middles;
  ArrayView<const float> widths;
  float cell_unit;
  ArrayView<Vec3f> out_middles;
  ArrayView<float> out_widths;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t from = chosen[i >> 3];
    const int slot = static_cast<int>(i & 7);
    const float width = 0.5F * widths[from];
    const float off = 0.5F * width * cell_unit;
    const Vec3f m = middles[from];
    out_middles[i] = {octree::slot_x(slot) != 0 ? m.x + off : m.x - off,
                      octree::slot_y(slot) != 0 ? m.y + off : m.y - off,
                      octree::slot_z(slot) != 0 ? m.z + off : m.z - off};
    out_widths[i] = width;
  }
};

/// One step of Newton's method: the nearest point where both distances, taken as linear, vanish; not farther than an
/// eighth's diagonal or so.
struct Step {
  ArrayView<const SurfaceDistance> to_a, to_b;
  ArrayView<const float> widths;
  float cell_unit;
  ArrayView<Vec3f> points;
  PSK_HD void operator()(std::int64_t i) const {
    const SurfaceDistance& a = to_a[i];
    const SurfaceDistance& b = to_b[i];
    if (run_alike(a, b)) return;
    const float c = dot(a.normal, b.normal);
    const float determinant = 1 - c * c;
    const float along_a = (c * b.cells - a.cells) / determinant;
    const float along_b = (c * a.cells - b.cells) / determinant;
    const Vec3f step = plus({along_a * a.normal.x, along_a * a.normal.y, along_a * a.normal.z}, along_b, b.normal);
    const float length = std::sqrt(dot(step, step));
    const float longest = 2 * widths[i];
    const float share = cell_unit * (length > longest ? longest / length : 1.0F);
    const Vec3f p = plus(points[i], share, step);
    points[i] = {in_unit(p.x), in_unit(p.y), in_unit(p.z)};
  }
};

struct AddLengths {
  PSK_HD double operator()(double a, double b) const { return a + b; }
};

struct SteepnessOfBoth {
  ArrayView<const SurfaceDistance> to_a, to_b;
  PSK_HD double operator()(std::int64_t i) const {
    return 0.5 * (static_cast<double>(to_a[i].steepness) + static_cast<double>(to_b[i].steepness));
  }
};

/// Points in the rows of a sheet, in its tangent plane.
struct PlaceRows {
  ArrayView<const Vec3f> points;
  ArrayView<const float> widths;
  ArrayView<const SurfaceDistance> own, other;
  bool outside;
  float cell_unit;
  ArrayView<Vec3f> out;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t k = i / kRows;
    const Vec3f n = own[k].normal;
    const Vec3f away = plus(other[k].normal, -dot(other[k].normal, n), n);  // from the other solid
    const float offset = row_offset(static_cast<int>(i % kRows)) * 2 * widths[k] * cell_unit;
    const Vec3f p = plus(points[k], (outside ? offset : -offset) / std::sqrt(dot(away, away)), away);
    out[i] = {in_unit(p.x), in_unit(p.y), in_unit(p.z)};
  }
};

struct Project {
  ArrayView<const SurfaceDistance> own;
  float cell_unit;
  ArrayView<Vec3f> points;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = plus(points[i], -own[i].cells * cell_unit, own[i].normal);
    points[i] = {in_unit(p.x), in_unit(p.y), in_unit(p.z)};
  }
};

/// True for samples on their surface and on the kept side of the other one.
struct IsOnSheet {
  ArrayView<const SurfaceDistance> own, other;
  ArrayView<const float> widths;
  bool outside;
  PSK_HD bool operator()(std::int64_t i) const {
    return size_of(own[i].cells) <= 0.1F * widths[i / kRows] && (other[i].cells > 0) == outside;
  }
};

struct WriteSamples {
  ArrayView<const std::int32_t> chosen;
  ArrayView<const Vec3f> points;
  ArrayView<const SurfaceDistance> own;
  bool flipped;
  ArrayView<Vec3f> positions, normals;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t from = chosen[i];
    const Vec3f n = own[from].normal;
    positions[i] = points[from];
    normals[i] = flipped ? Vec3f{-n.x, -n.y, -n.z} : n;
  }
};

float cell_of(const field::FieldView& f) { return 1.0F / static_cast<float>(1 << f.tree.depth); }

/// The eighths of the leaves of `a` that both surfaces may pass through.
template <exec::Space Exec>
Cubes shared_cubes(Exec& ex, const field::FieldView& a, const field::FieldView& b) {
  const exec::Buffer<std::int32_t> leaves = select(ex, "boolean.leaves", a.tree.nodes, IsCrossedLeaf{a});
  Cubes all = make_cubes(ex, leaves.size());
  for_each(ex, "boolean.leaves", all.size(), LeafCube{a.tree, leaves.cview(), all.middles.view(), all.widths.view()});
  auto to_b = exec::make_buffer<SurfaceDistance>(ex, all.size());
  field::measure_distances(ex, b, all.middles.cview(), to_b.view());
  const exec::Buffer<std::int32_t> shared =
      select(ex, "boolean.leaves", all.size(), MayCross{to_b.cview(), all.widths.cview()});
  Cubes eighths = make_cubes(ex, 8 * shared.size());
  for_each(ex, "boolean.leaves", eighths.size(),
           Split{shared.cview(), all.middles.cview(), all.widths.cview(), cell_of(a), eighths.middles.view(),
                 eighths.widths.view()});
  return eighths;
}

template <class T, exec::Space Exec>
exec::Buffer<T> chosen_of(Exec& ex, const exec::Buffer<T>& from, const exec::Buffer<std::int32_t>& chosen) {
  auto to = exec::make_buffer<T>(ex, chosen.size());
  exec::gather(ex, from.cview(), chosen.cview(), to.view());
  return to;
}

/// Points on one sheet with their distances to its own surface.
struct OnSheet {
  exec::Buffer<std::int32_t> chosen;
  exec::Buffer<Vec3f> points;
  exec::Buffer<SurfaceDistance> own;
  bool flipped;
};

template <exec::Space Exec>
OnSheet find_on_sheet(Exec& ex, const field::FieldView& own, const field::FieldView& other, const Crease& crease,
                      const Sheet& sheet) {
  const std::int64_t n = kRows * crease.size();
  const auto& to_own = sheet.of_first ? crease.to_a : crease.to_b;
  const auto& to_other = sheet.of_first ? crease.to_b : crease.to_a;
  OnSheet out{{}, exec::make_buffer<Vec3f>(ex, n), exec::make_buffer<SurfaceDistance>(ex, n), sheet.flipped};
  auto beside = exec::make_buffer<SurfaceDistance>(ex, n);
  for_each(ex, "boolean.sheets", n,
           PlaceRows{crease.points.cview(), crease.widths.cview(), to_own.cview(), to_other.cview(), sheet.outside,
                     cell_of(own), out.points.view()});
  for (int step = 0; step < 2; ++step) {
    field::measure_distances(ex, own, out.points.cview(), out.own.view());
    for_each(ex, "boolean.sheets", n, Project{out.own.cview(), cell_of(own), out.points.view()});
  }
  field::measure_distances(ex, own, out.points.cview(), out.own.view());
  field::measure_distances(ex, other, out.points.cview(), beside.view());
  out.chosen =
      select(ex, "boolean.sheets", n, IsOnSheet{out.own.cview(), beside.cview(), crease.widths.cview(), sheet.outside});
  return out;
}

}  // namespace

template <exec::Space Exec>
Crease find_crease(Exec& ex, const field::FieldView& a, const field::FieldView& b) {
  Cubes cubes = shared_cubes(ex, a, b);
  const std::int64_t n = cubes.size();
  Crease out;
  if (n == 0) return out;
  const float cell = cell_of(a);
  auto points = exec::make_buffer<Vec3f>(ex, n);
  auto to_a = exec::make_buffer<SurfaceDistance>(ex, n);
  auto to_b = exec::make_buffer<SurfaceDistance>(ex, n);
  copy(ex, cubes.middles.cview(), points.view());
  for (int step = 0; step <= kSteps; ++step) {
    field::measure_distances(ex, a, points.cview(), to_a.view());
    field::measure_distances(ex, b, points.cview(), to_b.view());
    if (step < kSteps)
      for_each(ex, "boolean.newton", n, Step{to_a.cview(), to_b.cview(), cubes.widths.cview(), cell, points.view()});
  }
  const Found found{points.cview(), cubes.middles.cview(), cubes.widths.cview(), to_a.cview(), to_b.cview(), cell};
  out.length_unit =
      static_cast<double>(cell) * exec::reduce<double>(ex, "boolean.length", n, TangentLength{found}, AddLengths{});
  const exec::Buffer<std::int32_t> chosen = select(ex, "boolean.curve", n, found);
  out.points = chosen_of(ex, points, chosen);
  out.widths = exec::make_buffer<float>(ex, chosen.size());
  exec::gather<float>(ex, cubes.widths.cview(), chosen.cview(), out.widths.view());
  out.to_a = chosen_of(ex, to_a, chosen);
  out.to_b = chosen_of(ex, to_b, chosen);
  return out;
}

template <exec::Space Exec>
SheetSamples sample_sheets(Exec& ex, const field::FieldView& a, const field::FieldView& b, const Crease& crease,
                           BooleanOp op) {
  std::vector<OnSheet> sheets;
  std::int64_t total = 0;
  for (const Sheet& sheet : kept_sheets(op)) {
    sheets.push_back(find_on_sheet(ex, sheet.of_first ? a : b, sheet.of_first ? b : a, crease, sheet));
    total += sheets.back().chosen.size();
  }
  SheetSamples out{exec::make_buffer<Vec3f>(ex, total), exec::make_buffer<Vec3f>(ex, total)};
  std::int64_t first = 0;
  for (const OnSheet& sheet : sheets) {
    const std::int64_t n = sheet.chosen.size();
    for_each(ex, "boolean.sheets", n,
             WriteSamples{sheet.chosen.cview(), sheet.points.cview(), sheet.own.cview(), sheet.flipped,
                          out.positions.view().part(first, n), out.normals.view().part(first, n)});
    first += n;
  }
  return out;
}

template <exec::Space Exec>
double steepness_at(Exec& ex, const Crease& crease) {
  const std::int64_t n = crease.size();
  return exec::reduce<double>(ex, "boolean.steepness", n, SteepnessOfBoth{crease.to_a.cview(), crease.to_b.cview()},
                              AddLengths{}) /
         static_cast<double>(n);
}

PSK_INSTANTIATE(find_crease);
PSK_INSTANTIATE(sample_sheets);
PSK_INSTANTIATE(steepness_at);

}  // namespace pointskin::boolean
