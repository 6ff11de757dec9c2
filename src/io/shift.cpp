#include "io/shift.hpp"

#include <algorithm>
#include <cmath>

#include "core/stray_limit.hpp"

namespace pointskin::io {
namespace {

/// Float keeps a surface exact enough if no coordinate is this many times its extent.
constexpr double kExactEnough = 1000;

/// And if none is this many steps of the file's coordinates: it is then off by a sixteenth of a step at most.
constexpr double kMostSteps = 1 << 20;

/// True if coordinates up to `reach` are exact enough for points that extend so far.
bool is_exact(double reach, double extent, double resolution) {
  return kExactEnough * extent >= reach && (resolution == 0 || kMostSteps * resolution >= reach);
}

/// How far a box reaches from a place, along an axis.
double reach_from(const Vec3d& place, const Box& box) {
  double reach = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    reach = std::max({reach, std::abs(box.lower[axis] - place[axis]), std::abs(box.upper[axis] - place[axis])});
  return reach;
}

/// The centre of a box in multiples of `step`.
Vec3d centre_of(const Box& box, double step) {
  Vec3d centre{};
  // Adding zero turns -0 into 0, which compares and prints as expected.
  for (std::size_t axis = 0; axis < 3; ++axis)
    centre[axis] = std::round((box.lower[axis] + box.upper[axis]) / 2 / step) * step + 0.0;
  return centre;
}

Vec3d shift_of(const Box& box, double resolution, bool has_digits) {
  const double magnitude = reach_from({}, box);
  const double extent = box.longest_side();
  if (magnitude == 0 || (extent == 0 && !has_digits) ||
      (magnitude < kExactEnough * extent && is_exact(magnitude, extent, resolution)))
    return {0, 0, 0};
  const Vec3d centre = centre_of(box, 1);
  if (extent == 0 || reach_from(centre, box) <= kExactEnough * extent) return centre;
  constexpr double kLeastStep = 1e-100;  // so that no coordinate overflows
  return centre_of(box, std::max(std::exp2(std::ilogb(extent)), kLeastStep));
}

/// The `rank`-th smallest lower and the `rank`-th largest upper ends along every axis.
Box ends_of(const std::vector<Box>& runs, std::int64_t rank) {
  Box ends;
  std::vector<double> values(runs.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::transform(runs.begin(), runs.end(), values.begin(), [&](const Box& run) { return run.lower[axis]; });
    ends.lower[axis] = smallest(values, rank, 0);
    std::transform(runs.begin(), runs.end(), values.begin(), [&](const Box& run) { return -run.upper[axis]; });
    ends.upper[axis] = -smallest(values, rank, 0);
  }
  return ends;
}

}  // namespace

Vec3d automatic_shift(const std::vector<Box>& runs, std::int64_t points, double resolution, bool has_digits,
                      const std::function<std::vector<Vec3d>(const Box&)>& beyond) {
  Box all;
  for (const Box& run : runs) all.add(run.lower, run.upper);
  const Vec3d shift = shift_of(all, resolution, has_digits);
  const std::int64_t limit = stray_limit(points);
  // Coordinates after the shift are up to this large. That is exact enough for the points without the strays if their
  // extent is not far below.
  const double reach = shift == Vec3d{} ? reach_from({}, all) : all.longest_side();
  const auto is_wide = [&](const Box& box) { return is_exact(reach, box.longest_side(), resolution); };
  // Each of the six ends of the middle leaves out `limit` points, so one of the wide runs would lie in it as a whole.
  if (limit == 0 || std::count_if(runs.begin(), runs.end(), is_wide) > 6 * limit) return shift;
  const Box ends = ends_of(runs, limit);
  const Box middle = middle_of(
      beyond(ends), [](const Vec3d& p) { return p; }, ends, limit);
  return is_wide(middle) ? shift : shift_of(middle, resolution, has_digits);
}

}  // namespace pointskin::io
