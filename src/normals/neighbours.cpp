#include "normals/neighbours.hpp"

#include <bit>
#include <cstdint>

#include "exec/this_space.hpp"
#include "normals/nearest_list.hpp"
#include "octree/access.hpp"
#include "octree/walk.hpp"

namespace pointskin::normals {

namespace {

struct Find {
  NearestSearch search;
  ArrayView<std::int32_t> ids;
  PSK_HD void operator()(std::int64_t i) const {
    NearestList<kNeighbours> list;
    search(i, list);
    std::int32_t* out = ids.data + i * kNeighbours;
    for (int j = 0; j < kNeighbours; ++j) out[j] = j < list.count() ? list[j] : -1;
  }
};

}  // namespace

template <exec::Space Exec>
exec::Buffer<std::int32_t> find_neighbours(Exec& ex, const octree::SearchView& points) {
  const std::int64_t n = points.positions.size;
  auto ids = exec::make_buffer<std::int32_t>(ex, n * kNeighbours);
  for_each(ex, "normals.neighbours", n, Find{{points}, ids.view()});
  return ids;
}

PSK_INSTANTIATE(find_neighbours);

}  // namespace pointskin::normals
