#include "poisson/mean_length.hpp"

#include "exec/exact_sum.hpp"
#include "exec/this_space.hpp"

namespace pointskin::poisson {
namespace {

struct LengthOf {
  ArrayView<const Vec3f> vectors;
  PSK_HD double operator()(std::int64_t i) const { return length_of(vectors[i]); }
};

}  // namespace

template <exec::Space Exec>
double mean_length(Exec& ex, ArrayView<const Vec3f> normals) {
  return exec::exact_sum(ex, "density.confidence", normals.size, LengthOf{normals}, kLengthFraction) /
         static_cast<double>(normals.size);
}

PSK_INSTANTIATE(mean_length);

}  // namespace pointskin::poisson
