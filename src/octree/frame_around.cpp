#include "core/format.hpp"
#include "octree/frame.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointskin::octree {

namespace {

/// Points that extend over a few steps of float have no shape that vertices could follow.
void check_resolution(const Vec3d& lower, const Vec3d& upper) {
  constexpr double kStep = 0x1p-23;  // between floats, of their magnitude
  constexpr double kFewSteps = 16;
  double reach = 0;
  double extent = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    reach = std::max({reach, std::abs(lower[a]), std::abs(upper[a])});
    extent = std::max(extent, upper[a] - lower[a]);
  }
  if (extent >= kFewSteps * kStep * reach) return;
  throw Error(
      ErrorCode::invalid_input,
      fmt::format("the points extend over {:.3g} and lie {:.3g} from the origin, where float coordinates are "
                  "{:.3g} apart; subtract an offset nearer to them, as --shift auto does, or move them less far",
                  extent, reach, reach * kStep));
}

}  // namespace

Frame frame_around(const Bounds& box, double scale) {
  const Vec3d lower{box.lower.x, box.lower.y, box.lower.z};
  const Vec3d upper{box.upper.x, box.upper.y, box.upper.z};
  Frame result;
  result.size = scale * std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  if (!(result.size > 0))
    throw Error(ErrorCode::empty_result, "all points are at one place; there is no surface to reconstruct");
  check_resolution(lower, upper);
  constexpr auto kLargest = static_cast<double>(std::numeric_limits<float>::max());
  for (std::size_t a = 0; a < 3; ++a) {
    result.lower[a] = 0.5 * (lower[a] + upper[a]) - 0.5 * result.size;
    if (!(std::max(std::abs(result.lower[a]), std::abs(result.lower[a] + result.size)) <= kLargest))
      throw Error(
          ErrorCode::invalid_input,
          "the working cube reaches beyond 3.4e38, the largest coordinate of a vertex; give the points in larger "
          "units, or a smaller scale");
  }
  return result;
}

double float_step(const Frame& frame) {
  constexpr int kFractionBits = 23;
  double reach = 0;
  for (std::size_t a = 0; a < 3; ++a)
    reach = std::max({reach, std::abs(frame.lower[a]), std::abs(frame.lower[a] + frame.size)});
  return std::ldexp(1.0, std::ilogb(reach) - kFractionBits);
}

}  // namespace pointskin::octree
