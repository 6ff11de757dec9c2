#include "edit/choice.hpp"

#include <cmath>

#include "exec/this_space.hpp"
#include "octree/access.hpp"

namespace pointskin::edit {
namespace {

struct IsInArea {
  ViewFrame view;
  Polygons area;
  ArrayView<const Vec3f> positions;
  ArrayView<const std::uint8_t> candidates;
  PSK_HD bool operator()(std::int64_t i) const {
    if (!candidates.empty() && candidates[i] == 0) return false;
    PlanePoint place;
    return view.project(positions[i], place) && area.contains(place);
  }
};

/// The deepest cell that counts at a point of the unit cube.
PSK_HD octree::Leaf leaf_at(const field::FieldView& f, std::uint64_t key) {
  octree::Leaf leaf;
  while (f.is_split(leaf.depth, leaf.cell)) {
    const std::int32_t brick = f.tree.levels[leaf.depth].child_brick[leaf.cell];
    ++leaf.depth;
    leaf.cell = 8 * brick + static_cast<std::int32_t>(octree::cell_key(key, leaf.depth) & 7);
  }
  return leaf;
}

/// True if the cell holds samples, or with `around` one of the 26 cells around it.
PSK_HD bool holds_samples(const octree::OctreeView& tree, const octree::Leaf& leaf, bool around) {
  const octree::LevelView& level = tree.levels[leaf.depth];
  const int reach = around ? 1 : 0;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z) {
        const std::int32_t cell = level.neighbour(leaf.cell, x, y, z);
        if (level.is_cell(cell) && level.point_begin[cell] < level.point_begin[cell + 1]) return true;
      }
  return false;
}

PSK_HD double width_of(const octree::Leaf& leaf) { return 1 / static_cast<double>(std::int64_t{1} << leaf.depth); }

/// A line of sight in the unit cube, from a point to the eye.
struct Sight {
  double from[3], along[3];  // unit length
  double length;             // to the eye

  [[nodiscard]] PSK_HD Vec3f at(double t) const {
    return {static_cast<float>(from[0] + t * along[0]), static_cast<float>(from[1] + t * along[1]),
            static_cast<float>(from[2] + t * along[2])};
  }
  /// Where the line leaves the box [c, c + 1] * width that it is in; the eye, if that is before.
  [[nodiscard]] PSK_HD double leaves(const octree::Coordinates& c, double width) const {
    const std::int32_t cell[3] = {c.x, c.y, c.z};
    double t = length;
    for (int a = 0; a < 3; ++a) {
      if (along[a] == 0) continue;
      const double face = (cell[a] + (along[a] > 0 ? 1 : 0)) * width;
      const double there = (face - from[a]) / along[a];
      if (there < t) t = there;
    }
    return t;
  }
};

PSK_HD Sight sight_of(const ViewFrame& view, const octree::Frame& cube, const Vec3f& position) {
  constexpr double kFar = 4;  // beyond the cube, whatever the direction
  const Vec3f p = cube.to_unit(position);
  Sight sight{{p.x, p.y, p.z}, {view.back[0], view.back[1], view.back[2]}, kFar};
  if (view.perspective)
    for (int a = 0; a < 3; ++a) sight.along[a] = (view.eye[a] - cube.lower[a]) / cube.size - sight.from[a];
  const double* d = sight.along;
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  if (view.perspective) sight.length = length;
  for (double& component : sight.along) component = length > 0 ? component / length : 0;
  return sight;
}

/// A leaf with the field in it.
struct Cell {
  octree::Leaf leaf;
  octree::Coordinates place;
  float isovalue = 0;
  float corners[8] = {};

  [[nodiscard]] PSK_HD bool is_inside(const Vec3f& p) const {
    const Vec3f local = octree::local_in_cell(p, place, leaf.depth);
    float value = 0;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) value += corners[s] * octree::corner_weight(s, local);
    return value >= isovalue;
  }
};

struct IsSeen {
  ViewFrame view;
  Screen screen;
  ArrayView<const Vec3f> positions;
  ArrayView<const std::int32_t> chosen;

  PSK_HD bool operator()(std::int64_t i) const {
    const octree::OctreeView& tree = screen.field.tree;
    const Sight sight = sight_of(view, screen.cube, positions[chosen[i]]);
    const octree::Leaf own = cell_at(sight.at(0)).leaf;
    const double end = sight.leaves({0, 0, 0}, 1);
    // A step that is lost in rounding at the face of a leaf goes on by a little.
    const double least = 1e-3 / static_cast<double>(std::int64_t{1} << tree.depth);
    double t = kSurfaceCells * width_of(own);
    bool was_inside = t < end && cell_at(sight.at(t)).is_inside(sight.at(t));
    if (was_inside && !screen.only_at_samples) return false;
    while (t < end) {
      const Cell cell = cell_at(sight.at(t + least));
      double next = sight.leaves(cell.place, width_of(cell.leaf));
      if (!(next > t + least)) next = t + least;
      if (next > end) next = end;
      const bool in_middle = cell.is_inside(sight.at(0.5 * (t + next)));
      const bool in_end = cell.is_inside(sight.at(next));
      if ((in_middle || in_end) && !screen.only_at_samples) return false;
      if ((in_middle != was_inside || in_end != in_middle) &&
          holds_samples(tree, cell.leaf, cell.leaf.depth >= own.depth))
        return false;
      was_inside = in_end;
      t = next;
    }
    return true;
  }

  [[nodiscard]] PSK_HD Cell cell_at(const Vec3f& p) const {
    const field::FieldView& f = screen.field;
    const std::uint64_t key = octree::point_key(p.x, p.y, p.z);
    const octree::Leaf leaf = leaf_at(f, key);
    const octree::LevelView& level = f.tree.levels[leaf.depth];
    Cell cell{leaf, octree::decode(octree::cell_key(key, leaf.depth)), f.isovalue};
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const std::int32_t corner = level.neighbour(leaf.cell, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
      cell.corners[s] = f.values[level.first_node + corner];
    }
    return cell;
  }
};

struct Unmark {
  ArrayView<const std::int32_t> chosen;
  ArrayView<std::uint8_t> marks;
  PSK_HD void operator()(std::int64_t i) const { marks[chosen[i]] = 0; }
};

struct IsMarked {
  ArrayView<const std::uint8_t> marks;
  PSK_HD bool operator()(std::int64_t i) const { return marks[i] != 0; }
};

}  // namespace

template <exec::Space Exec>
exec::Buffer<std::int32_t> points_in(Exec& ex, const ViewFrame& view, const Polygons& area,
                                     ArrayView<const Vec3f> positions, ArrayView<const std::uint8_t> candidates) {
  return select(ex, "edit.choose", positions.size, IsInArea{view, area, positions, candidates});
}

template <exec::Space Exec>
exec::Buffer<std::int32_t> not_hidden(Exec& ex, const ViewFrame& view, const Screen& screen,
                                      ArrayView<const Vec3f> positions, ArrayView<const std::int32_t> chosen) {
  const exec::Buffer<std::int32_t> seen =
      select(ex, "edit.front", chosen.size, IsSeen{view, screen, positions, chosen});
  auto indices = exec::make_buffer<std::int32_t>(ex, seen.size());
  exec::gather(ex, chosen, seen.cview(), indices.view());
  return indices;
}

template <exec::Space Exec>
exec::Buffer<std::int32_t> all_but(Exec& ex, std::int64_t n, ArrayView<const std::int32_t> chosen) {
  auto marks = exec::make_buffer<std::uint8_t>(ex, n);
  exec::fill(ex, marks.view(), std::uint8_t{1});
  for_each(ex, "edit.rest", chosen.size, Unmark{chosen, marks.view()});
  return select(ex, "edit.rest", n, IsMarked{marks.cview()});
}

PSK_INSTANTIATE(points_in);
PSK_INSTANTIATE(not_hidden);
PSK_INSTANTIATE(all_but);

}  // namespace pointskin::edit
