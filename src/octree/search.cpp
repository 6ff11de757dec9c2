#include "octree/search.hpp"

#include <pointskin/error.hpp>

#include <limits>

#include "exec/this_space.hpp"
#include "octree/access.hpp"
#include "octree/walk.hpp"

namespace pointskin::octree {
namespace {

struct FindNearest {
  SearchView points;
  ArrayView<const Vec3f> queries;
  int k;
  ArrayView<std::int32_t> ids;
  ArrayView<float> squared;

  PSK_HD void operator()(std::int64_t query) const {
    const Vec3f q = queries[query];
    std::int32_t* id = ids.data + query * k;
    float* distance = squared.data + query * k;
    int found = 0;
    const auto prune = [&](float d) { return found == k && d > distance[k - 1]; };
    walk(points, q, prune, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t p = first; p < last; ++p)
        found = insert(points.ids[p], squared_distance(q, points.positions[p]), id, distance, found);
    });
    for (; found < k; ++found) id[found] = -1;
  }

  /// Keeps the list sorted by (distance, id). @returns the new number of entries
  PSK_HD int insert(std::int32_t new_id, float d, std::int32_t* id, float* distance, int found) const {
    const auto before = [&](int i) { return d < distance[i] || (d == distance[i] && new_id < id[i]); };
    if (found == k && !before(k - 1)) return found;
    int place = found < k ? found : k - 1;
    for (; place > 0 && before(place - 1); --place) {
      id[place] = id[place - 1];
      distance[place] = distance[place - 1];
    }
    id[place] = new_id;
    distance[place] = d;
    return found < k ? found + 1 : k;
  }
};

struct FindNearestPlace {
  SearchView points;
  ArrayView<const Vec3f> queries;
  ArrayView<std::int32_t> places;

  struct Best {
    float squared = std::numeric_limits<float>::infinity();
    std::int32_t place = -1;
  };

  PSK_HD void operator()(std::int64_t query) const {
    const Vec3f q = queries[query];
    const Leaf leaf = locate(points.tree, point_key(q.x, q.y, q.z), points.tree.depth);
    const LevelView& level = points.tree.levels[leaf.depth];
    const Coordinates at = decode(level.node_key(leaf.cell));
    Best best;
    scan(points.first_of(level, leaf.cell), points.first_of(level, leaf.cell + 1), q, best);
    for (int i = 0; i < kNeighbours; ++i)
      if (i != kSelf) scan_neighbour(level, leaf.cell, at, {i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1}, q, best);
    const float reach = reach_of_neighbours(q, at, leaf.depth);
    if (!(reach > 0 && best.squared < reach * reach))
      walk(
          points, q, [&](float d) { return d > best.squared; },
          [&](std::int32_t first, std::int32_t last) { scan(first, last, q, best); });
    places[query] = best.place;
  }

  PSK_HD void scan_neighbour(const LevelView& level, std::int32_t cell, const Coordinates& at, const Coordinates& step,
                             const Vec3f& q, Best& best) const {
    const Coordinates c{at.x + step.x, at.y + step.y, at.z + step.z};
    if (squared_distance_to_cell(q, c, level.depth) > best.squared) return;
    const std::int32_t neighbour = level.neighbour(cell, step.x, step.y, step.z);
    if (!level.is_cell(neighbour)) return;
    scan(points.first_of(level, neighbour), points.first_of(level, neighbour + 1), q, best);
  }

  PSK_HD void scan(std::int32_t first, std::int32_t last, const Vec3f& q, Best& best) const {
    for (std::int32_t p = first; p < last; ++p) {
      const float squared = squared_distance(q, points.positions[p]);
      if (squared < best.squared || (squared == best.squared && p < best.place)) best = {squared, p};
    }
  }

  /// No point outside of the 27 cells around is nearer than this, a little less than exact.
  PSK_HD static float reach_of_neighbours(const Vec3f& q, const Coordinates& at, int depth) {
    const float width = 1.0F / static_cast<float>(1 << depth);
    const auto gap = [&](float v, std::int32_t lower) {
      const float below = v - static_cast<float>(lower - 1) * width;
      const float above = static_cast<float>(lower + 2) * width - v;
      return below < above ? below : above;
    };
    const float x = gap(q.x, at.x);
    const float y = gap(q.y, at.y);
    const float z = gap(q.z, at.z);
    const float least = x < y ? x : y;
    return (least < z ? least : z) * (1 - 1e-5F);
  }
};

struct CountWithin {
  SearchView points;
  ArrayView<const Vec3f> queries;
  float squared_radius;
  ArrayView<std::int32_t> count;
  PSK_HD void operator()(std::int64_t query) const {
    const Vec3f q = queries[query];
    std::int32_t sum = 0;
    const auto prune = [&](float d) { return d > squared_radius; };
    walk(points, q, prune, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t p = first; p < last; ++p)
        if (squared_distance(q, points.positions[p]) <= squared_radius) ++sum;
    });
    count[query] = sum;
  }
};

struct WriteWithin {
  SearchView points;
  ArrayView<const Vec3f> queries;
  float squared_radius;
  ArrayView<const std::int32_t> begin;
  ArrayView<std::int32_t> order;  // place of the point among the sorted ones
  PSK_HD void operator()(std::int64_t query) const {
    const Vec3f q = queries[query];
    const std::int32_t from = begin[query];
    std::int32_t to = from;
    const auto prune = [&](float d) { return d > squared_radius; };
    walk(points, q, prune, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t p = first; p < last; ++p)
        if (squared_distance(q, points.positions[p]) <= squared_radius) order[to++] = p;
    });
    sort(from, to);
  }

  /// Cells come nearest first; the result is in key order. Heap sort: no recursion, no extra memory.
  PSK_HD void sort(std::int32_t from, std::int32_t to) const {
    std::int32_t* heap = order.data + from;
    const std::int32_t n = to - from;
    for (std::int32_t i = n / 2 - 1; i >= 0; --i) sift(heap, i, n);
    for (std::int32_t end = n - 1; end > 0; --end) {
      const std::int32_t largest = heap[0];
      heap[0] = heap[end];
      heap[end] = largest;
      sift(heap, 0, end);
    }
  }
  PSK_HD static void sift(std::int32_t* heap, std::int32_t i, std::int32_t n) {
    for (std::int32_t child = 2 * i + 1; child < n; child = 2 * i + 1) {
      if (child + 1 < n && heap[child + 1] > heap[child]) ++child;
      if (heap[i] >= heap[child]) return;
      const std::int32_t swapped = heap[i];
      heap[i] = heap[child];
      heap[child] = swapped;
      i = child;
    }
  }
};

struct DescribeWithin {
  SearchView points;
  ArrayView<const Vec3f> queries;
  ArrayView<const std::int32_t> begin;
  ArrayView<std::int32_t> ids;  // holds places, receives ids
  ArrayView<float> squared;
  PSK_HD void operator()(std::int64_t query) const {
    for (std::int32_t i = begin[query]; i < begin[query + 1]; ++i) {
      const std::int32_t place = ids[i];
      squared[i] = squared_distance(queries[query], points.positions[place]);
      ids[i] = points.ids[place];
    }
  }
};

}  // namespace

template <exec::Space Exec>
void find_nearest(Exec& ex, const SearchView& points, ArrayView<const Vec3f> queries, int k,
                  ArrayView<std::int32_t> ids, ArrayView<float> squared) {
  for_each(ex, "search.nearest", queries.size, FindNearest{points, queries, k, ids, squared});
}

template <exec::Space Exec>
void find_nearest_place(Exec& ex, const SearchView& points, ArrayView<const Vec3f> queries,
                        ArrayView<std::int32_t> places) {
  for_each(ex, "search.nearest", queries.size, FindNearestPlace{points, queries, places});
}

template <exec::Space Exec>
WithinRadius find_within(Exec& ex, const SearchView& points, ArrayView<const Vec3f> queries, float radius) {
  WithinRadius result;
  auto count = exec::make_buffer<std::int32_t>(ex, queries.size);
  result.begin = exec::make_buffer<std::int32_t>(ex, queries.size + 1);
  if (queries.empty()) {
    exec::fill(ex, result.begin.view(), std::int32_t{0});
    return result;
  }
  const float squared = radius * radius;
  for_each(ex, "search.count", queries.size, CountWithin{points, queries, squared, count.view()});
  const std::int64_t total = exec::sum_counts(ex, "search.count", count.cview());
  if (total > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "more than 2^31 neighbours in all; choose a smaller radius or fewer queries");
  exclusive_scan(ex, "search.count", count.cview(), result.begin.view());
  result.ids = exec::make_buffer<std::int32_t>(ex, total);
  result.squared = exec::make_buffer<float>(ex, total);
  for_each(ex, "search.write", queries.size,
           WriteWithin{points, queries, squared, result.begin.cview(), result.ids.view()});
  for_each(ex, "search.write", queries.size,
           DescribeWithin{points, queries, result.begin.cview(), result.ids.view(), result.squared.view()});
  return result;
}

PSK_INSTANTIATE(find_nearest);
PSK_INSTANTIATE(find_nearest_place);
PSK_INSTANTIATE(find_within);

}  // namespace pointskin::octree
