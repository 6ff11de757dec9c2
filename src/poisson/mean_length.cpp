#include "poisson/mean_length.hpp"

#include <cmath>

#include "exec/exact_sum.hpp"
#include "exec/this_space.hpp"

namespace pointskin::poisson {
namespace {

struct LengthOf {
  ArrayView<const Vec3f> vectors;
  PSK_HD double operator()(std::int64_t i) const {
    const Vec3f v = vectors[i];
    return std::sqrt(double{v.x} * v.x + double{v.y} * v.y + double{v.z} * v.z);
  }
};

/// Normals are mostly of about length 1.
constexpr int kFraction = 64;

}  // namespace

template <exec::Space Exec>
double mean_length(Exec& ex, ArrayView<const Vec3f> normals) {
  return exec::exact_sum(ex, "density.confidence", normals.size, LengthOf{normals}, kFraction) /
         static_cast<double>(normals.size);
}

PSK_INSTANTIATE(mean_length);

}  // namespace pointskin::poisson
