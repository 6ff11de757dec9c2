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

double largest_magnitude(const Box& box) {
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    largest = std::max({largest, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
  return largest;
}

Vec3d shift_of(const Box& box, double resolution) {
  const double magnitude = largest_magnitude(box);
  if (magnitude == 0 ||
      (magnitude < kExactEnough * box.longest_side() && is_exact(magnitude, box.longest_side(), resolution)))
    return {0, 0, 0};
  Vec3d centre{};
  // Adding zero turns -0 into 0, which compares and prints as expected.
  for (std::size_t axis = 0; axis < 3; ++axis) centre[axis] = std::round((box.lower[axis] + box.upper[axis]) / 2) + 0.0;
  return centre;
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

Vec3d automatic_shift(const std::vector<Box>& runs, std::int64_t points, double resolution,
                      const std::function<std::vector<Vec3d>(const Box&)>& beyond) {
  Box all;
  for (const Box& run : runs) all.add(run.lower, run.upper);
  const Vec3d shift = shift_of(all, resolution);
  const std::int64_t limit = stray_limit(points);
  // Coordinates after the shift are up to this large. That is exact enough for the points without the strays if their
  // extent is not far below.
  const double reach = shift == Vec3d{} ? largest_magnitude(all) : all.longest_side();
  const auto is_wide = [&](const Box& box) { return is_exact(reach, box.longest_side(), resolution); };
  // Each of the six ends of the middle leaves out `limit` points, so one of the wide runs would lie in it as a whole.
  if (limit == 0 || std::count_if(runs.begin(), runs.end(), is_wide) > 6 * limit) return shift;
  const Box ends = ends_of(runs, limit);
  const Box middle = middle_of(
      beyond(ends), [](const Vec3d& p) { return p; }, ends, limit);
  return is_wide(middle) ? shift : shift_of(middle, resolution);
}

}  // namespace pointskin::io
