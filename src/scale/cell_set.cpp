#include "scale/cell_set.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace pointskin::scale {

std::span<const CellSet::Interval> CellSet::Columns::of(std::size_t column) const {
  const auto first = static_cast<std::size_t>(columns[column].first);
  const std::size_t end =
      column + 1 < columns.size() ? static_cast<std::size_t>(columns[column + 1].first) : intervals.size();
  return std::span(intervals).subspan(first, end - first);
}

void CellSet::add_column(Columns& to, std::int32_t x, std::int32_t y, std::vector<Interval>& intervals) {
  std::sort(intervals.begin(), intervals.end(), [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
  const auto first = static_cast<std::int64_t>(to.intervals.size());
  to.columns.push_back({x, y, first});
  for (const Interval& next : intervals) {
    const bool is_first = static_cast<std::int64_t>(to.intervals.size()) == first;
    if (is_first || next.begin > to.intervals.back().end)
      to.intervals.push_back(next);
    else
      to.intervals.back().end = std::max(to.intervals.back().end, next.end);
  }
}

CellSet::CellSet(int level, std::span<const std::uint64_t> keys) : level_(level) {
  std::vector<octree::Coordinates> cells;
  cells.reserve(keys.size());
  for (const std::uint64_t key : keys) cells.push_back(octree::decode(key));
  std::sort(cells.begin(), cells.end(), [](const octree::Coordinates& a, const octree::Coordinates& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  });
  std::vector<Interval> column;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    column.push_back({cells[i].z, cells[i].z + 1});
    if (i + 1 < cells.size() && cells[i + 1].x == cells[i].x && cells[i + 1].y == cells[i].y) continue;
    add_column(columns_, cells[i].x, cells[i].y, column);
    column.clear();
  }
  find_box();
}

void CellSet::find_box() {
  if (columns_.columns.empty()) {
    upper_ = {-1, -1, -1};
    return;
  }
  lower_ = {columns_.columns.front().x, columns_.columns.front().y, columns_.intervals.front().begin};
  upper_ = {columns_.columns.back().x, lower_.y, lower_.z};
  for (const Column& column : columns_.columns) {
    lower_.y = std::min(lower_.y, column.y);
    upper_.y = std::max(upper_.y, column.y);
  }
  for (const Interval& interval : columns_.intervals) {
    lower_.z = std::min(lower_.z, interval.begin);
    upper_.z = std::max(upper_.z, interval.end - 1);
  }
}

std::int64_t CellSet::size() const {
  std::int64_t cells = 0;
  for (const Interval& interval : columns_.intervals) cells += interval.end - interval.begin;
  return cells;
}

bool CellSet::contains(const octree::Coordinates& cell) const {
  if (cell.x < lower_.x || cell.y < lower_.y || cell.z < lower_.z || cell.x > upper_.x || cell.y > upper_.y ||
      cell.z > upper_.z)
    return false;
  const auto column = std::lower_bound(
      columns_.columns.begin(), columns_.columns.end(), cell,
      [](const Column& a, const octree::Coordinates& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  if (column == columns_.columns.end() || column->x != cell.x || column->y != cell.y) return false;
  const std::span<const Interval> all = columns_.of(static_cast<std::size_t>(column - columns_.columns.begin()));
  const auto next = std::upper_bound(all.begin(), all.end(), cell.z,
                                     [](std::int32_t z, const Interval& interval) { return z < interval.begin; });
  return next != all.begin() && cell.z < (next - 1)->end;
}

std::vector<std::uint64_t> CellSet::keys() const {
  std::vector<std::uint64_t> keys;
  keys.reserve(static_cast<std::size_t>(size()));
  for (std::size_t i = 0; i < columns_.columns.size(); ++i)
    for (const Interval& interval : columns_.of(i))
      for (std::int32_t z = interval.begin; z < interval.end; ++z)
        keys.push_back(octree::encode({columns_.columns[i].x, columns_.columns[i].y, z}));
  std::sort(keys.begin(), keys.end());
  return keys;
}

CellSet::Columns CellSet::grown_along_z(const Columns& from, int reach, std::int32_t side) {
  Columns to;
  to.columns.reserve(from.columns.size());
  std::vector<Interval> longer;
  for (std::size_t i = 0; i < from.columns.size(); ++i) {
    longer.clear();
    for (const Interval& interval : from.of(i))
      longer.push_back({std::max(interval.begin - reach, 0), std::min(interval.end + reach, side)});
    add_column(to, from.columns[i].x, from.columns[i].y, longer);
  }
  return to;
}

CellSet::Columns CellSet::grown_along_y(const Columns& from, int reach, std::int32_t side) {
  Columns to;
  const std::vector<Column>& columns = from.columns;
  std::vector<Interval> merged;
  for (std::size_t begin = 0, end = 0; begin < columns.size(); begin = end) {  // columns of one x
    const std::int32_t x = columns[begin].x;
    while (end < columns.size() && columns[end].x == x) ++end;
    std::size_t low = begin;  // [low, high): columns in reach of y
    std::size_t high = begin;
    for (std::int32_t y = std::max(columns[begin].y - reach, 0); y < side; ++y) {
      while (high < end && columns[high].y <= y + reach) ++high;
      while (low < high && columns[low].y < y - reach) ++low;
      if (low == high) {
        if (high == end) break;
        y = columns[high].y - reach - 1;  // nothing in between; the loop adds 1
        continue;
      }
      merged.clear();
      for (std::size_t i = low; i < high; ++i)
        for (const Interval& interval : from.of(i)) merged.push_back(interval);
      add_column(to, x, y, merged);
    }
  }
  return to;
}

CellSet::Columns CellSet::transposed(const Columns& from) {
  std::vector<std::size_t> order(from.columns.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&from](std::size_t a, std::size_t b) {
    return std::tie(from.columns[a].y, from.columns[a].x) < std::tie(from.columns[b].y, from.columns[b].x);
  });
  Columns to;
  to.columns.reserve(order.size());
  to.intervals.reserve(from.intervals.size());
  for (const std::size_t i : order) {
    to.columns.push_back({from.columns[i].y, from.columns[i].x, static_cast<std::int64_t>(to.intervals.size())});
    const std::span<const Interval> all = from.of(i);
    to.intervals.insert(to.intervals.end(), all.begin(), all.end());
  }
  return to;
}

CellSet CellSet::grown(int reach) const {
  const auto side = static_cast<std::int32_t>(std::int32_t{1} << level_);
  Columns grown = grown_along_z(columns_, reach, side);
  grown = grown_along_y(grown, reach, side);
  grown = transposed(grown_along_y(transposed(grown), reach, side));
  return {std::move(grown), level_};
}

}  // namespace pointskin::scale
