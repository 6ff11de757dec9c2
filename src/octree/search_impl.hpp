#pragma once

#include <pointskin/error.hpp>

#include <limits>

#include "exec/algorithms.hpp"
#include "octree/search.hpp"
#include "octree/walk.hpp"

namespace pointskin::octree {
namespace search {

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

}  // namespace search

template <exec::Space Exec>
void find_nearest(Exec& ex, const SearchView& points, ArrayView<const Vec3f> queries, int k,
                  ArrayView<std::int32_t> ids, ArrayView<float> squared) {
  for_each(ex, "search.nearest", queries.size, search::FindNearest{points, queries, k, ids, squared});
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
  for_each(ex, "search.count", queries.size, search::CountWithin{points, queries, squared, count.view()});
  const std::int64_t total = exec::sum_counts(ex, "search.count", count.cview());
  if (total > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "more than 2^31 neighbours in all; choose a smaller radius or fewer queries");
  exclusive_scan(ex, "search.count", count.cview(), result.begin.view());
  result.ids = exec::make_buffer<std::int32_t>(ex, total);
  result.squared = exec::make_buffer<float>(ex, total);
  for_each(ex, "search.write", queries.size,
           search::WriteWithin{points, queries, squared, result.begin.cview(), result.ids.view()});
  for_each(ex, "search.write", queries.size,
           search::DescribeWithin{points, queries, result.begin.cview(), result.ids.view(), result.squared.view()});
  return result;
}

}  // namespace pointskin::octree
