#include <pointskin/cloud.hpp>

#include "exec/cpu_primitives.hpp"
#include "octree/strays.hpp"

namespace pointskin {

Strays find_strays(const std::vector<Vec3f>& positions, int threads) {
  if (positions.empty()) return {};
  exec::Cpu ex(threads);
  const octree::StrayPoints found =
      octree::find_strays(ex, ArrayView<const Vec3f>{positions.data(), static_cast<std::int64_t>(positions.size())});
  return {{found.indices.begin(), found.indices.end()}, found.core};
}

}  // namespace pointskin
