#include "surface/volume.hpp"

#include <cmath>

#include "exec/this_space.hpp"

namespace pointskin::surface {
namespace {

struct AddModulo {
  static constexpr bool kAnyOrder = true;
  PSK_HD std::uint64_t operator()(std::uint64_t a, std::uint64_t b) const { return a + b; }
};

}  // namespace

template <exec::Space Exec>
int sign_of_volume(Exec& ex, int depth, const Surface& mesh) {
  const auto six = static_cast<std::int64_t>(
      exec::reduce<std::uint64_t>(ex, "surface.volume", mesh.triangles.size(), volumes_of(depth, mesh), AddModulo{}));
  // (1/16 cell)^3 in quanta, which are coarser than that at the deepest levels.
  const double of_triangle = std::ldexp(1.0, 3 * (depth_of_quanta(depth) - depth - 4));
  const double rounding = 6 * of_triangle * static_cast<double>(mesh.triangles.size());
  if (std::abs(static_cast<double>(six)) <= rounding) return 0;
  return six > 0 ? 1 : -1;
}

PSK_INSTANTIATE(sign_of_volume);

}  // namespace pointskin::surface
