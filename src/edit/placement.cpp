#include "edit/placement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "exec/this_space.hpp"

namespace pointskin::edit {
namespace {

using namespace snap;

struct Place {
  Placement placement;
  ArrayView<Vec3f> positions, normals;
  PSK_HD void operator()(std::int64_t i) const {
    positions[i] = placement.place(positions[i]);
    normals[i] = placement.turned(normals[i]);
  }
};

struct ToQuery {
  Placement motion;
  octree::Frame cube;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec3f> queries;
  PSK_HD void operator()(std::int64_t i) const { queries[i] = cube.to_unit(motion.place(positions[i])); }
};

/// The equation of one point.
struct EquationsOf {
  SnapTarget target;
  Placement motion;
  double centre[3];
  double farthest;  ///< match, world units
  ArrayView<const Vec3f> positions, normals;
  ArrayView<const std::int32_t> matches;

  PSK_HD Equations operator()(std::int64_t i) const {
    Equations sum;
    const std::int32_t match = matches[i];
    if (match < 0) return sum;
    const Vec3f p = motion.place(positions[i]);
    const Vec3f q = target.cube.to_world(target.points.positions[match]);
    const Vec3f n = target.normals[match];
    const Vec3f own = motion.turned(normals[i]);
    const double d[3] = {static_cast<double>(q.x) - p.x, static_cast<double>(q.y) - p.y,
                         static_cast<double>(q.z) - p.z};
    const double squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double agree =
        static_cast<double>(own.x) * n.x + static_cast<double>(own.y) * n.y + static_cast<double>(own.z) * n.z;
    const double length = std::sqrt(static_cast<double>(own.x) * own.x + static_cast<double>(own.y) * own.y +
                                    static_cast<double>(own.z) * own.z);
    if (!(squared <= farthest * farthest && agree > 0.5 * length)) return sum;
    const double r[3] = {p.x - centre[0], p.y - centre[1], p.z - centre[2]};
    const double row[6] = {r[1] * n.z - r[2] * n.y, r[2] * n.x - r[0] * n.z, r[0] * n.y - r[1] * n.x, n.x, n.y, n.z};
    const double gap = d[0] * n.x + d[1] * n.y + d[2] * n.z;
    int at = 0;
    for (int a = 0; a < 6; ++a) {
      for (int b = a; b < 6; ++b) sum.matrix[at++] = row[a] * row[b];
      sum.right[a] = row[a] * gap;
    }
    sum.squared = squared;
    sum.count = 1;
    return sum;
  }
};

struct AddEquations {
  PSK_HD Equations operator()(const Equations& a, const Equations& b) const {
    Equations sum;
    for (int i = 0; i < 21; ++i) sum.matrix[i] = a.matrix[i] + b.matrix[i];
    for (int i = 0; i < 6; ++i) sum.right[i] = a.right[i] + b.right[i];
    sum.squared = a.squared + b.squared;
    sum.count = a.count + b.count;
    return sum;
  }
};

}  // namespace

template <exec::Space Exec>
void place(Exec& ex, const Placement& placement, ArrayView<Vec3f> positions, ArrayView<Vec3f> normals) {
  for_each(ex, "insert.place", positions.size, Place{placement, positions, normals});
}

template <exec::Space Exec>
std::optional<Placement> find_snap(Exec& ex, const SnapTarget& target, ArrayView<const Vec3f> positions,
                                   ArrayView<const Vec3f> normals) {
  constexpr int kRounds = 40;
  constexpr double kFarthestShare = 0.1;  // of the diagonal, before a round has told how well the points fit
  constexpr double kFewest = 20;
  const Bounds box = octree::box_around(ex, positions);
  const auto middle = [](float low, float high) { return static_cast<float>(0.5 * (double{low} + high)); };
  const Vec3f centre{middle(box.lower.x, box.upper.x), middle(box.lower.y, box.upper.y),
                     middle(box.lower.z, box.upper.z)};
  const double radius = 0.5 * std::hypot(double{box.upper.x} - box.lower.x, double{box.upper.y} - box.lower.y,
                                         double{box.upper.z} - box.lower.z);
  const auto n = static_cast<double>(positions.size);
  const double cell = target.cube.size / static_cast<double>(std::int64_t{1} << target.points.tree.depth);
  auto queries = exec::make_buffer<Vec3f>(ex, positions.size);
  auto matches = exec::make_buffer<std::int32_t>(ex, positions.size);
  auto squared = exec::make_buffer<float>(ex, positions.size);
  Placement motion;
  double farthest = 2 * radius * kFarthestShare;
  for (int round = 0; round < kRounds; ++round) {
    for_each(ex, "insert.query", positions.size, ToQuery{motion, target.cube, positions, queries.view()});
    octree::find_nearest(ex, target.points, queries.cview(), 1, matches.view(), squared.view());
    const Vec3f moved = motion.place(centre);
    const auto equations = exec::reduce<Equations>(
        ex, "insert.snap", positions.size,
        EquationsOf{target, motion, {moved.x, moved.y, moved.z}, farthest, positions, normals, matches.cview()},
        AddEquations{});
    if (equations.count < std::max(kFewest, n / 20)) return std::nullopt;
    double change = 0;
    if (!step(equations, {moved.x, moved.y, moved.z}, radius, motion, change)) return std::nullopt;
    farthest = std::min(farthest, std::max(3 * std::sqrt(equations.squared / equations.count), cell));
    if (change < 1e-4 * cell) break;
  }
  return motion;
}

PSK_INSTANTIATE(place);
PSK_INSTANTIATE(find_snap);

}  // namespace pointskin::edit
