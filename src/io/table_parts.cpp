#include "io/table_parts.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

std::int64_t value_bytes(const Column& column) { return static_cast<std::int64_t>(size_of(column.stored)); }

/// Bytes from the first value of a row to that of `count` rows later, less what lies behind the last.
std::size_t span_bytes(std::int64_t count, std::int64_t stride, std::int64_t width) {
  return count > 0 ? static_cast<std::size_t>((count - 1) * stride + width) : 0;
}

}  // namespace

bool TableParts::holds(const Input& input, const PointTable& table) {
  if (table.rows == 0) return true;
  const std::string_view bytes = input.source().bytes;
  const std::less_equal<const char*> not_after;  // also of pointers into different memory
  return std::all_of(table.columns.begin(), table.columns.end(), [&](const Column& column) {
    if (!not_after(bytes.data(), column.data) || !not_after(column.data, bytes.data() + bytes.size())) return false;
    const auto left = static_cast<std::size_t>(bytes.data() + bytes.size() - column.data);
    const auto width = static_cast<std::size_t>(value_bytes(column));
    return column.stride_bytes >= 0 && left >= width &&
           fits(static_cast<std::uint64_t>(table.rows - 1), static_cast<std::uint64_t>(column.stride_bytes),
                left - width);
  });
}

TableParts::TableParts(const Input& input, PointTable table) : input_(input), table_(std::move(table)) {
  if (table_.rows == 0) return;  // columns of nothing may lie anywhere
  const std::vector<Column>& columns = table_.columns;
  std::vector<std::size_t> order(columns.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(columns[a].stride_bytes, columns[a].data) < std::pair(columns[b].stride_bytes, columns[b].data);
  });
  const char* const start = input_.source().bytes.data();
  for (const std::size_t c : order) {
    const std::size_t at = static_cast<std::size_t>(columns[c].data - start);
    const std::int64_t bytes = value_bytes(columns[c]);
    const std::int64_t stride = columns[c].stride_bytes;
    const auto behind = [&](const Band& band) { return static_cast<std::int64_t>(at - band.at) + bytes; };
    if (bands_.empty() || bands_.back().stride != stride || behind(bands_.back()) > stride)
      bands_.push_back({at, 0, stride, {}});
    bands_.back().width = std::max(bands_.back().width, behind(bands_.back()));
    bands_.back().columns.push_back(c);
  }
}

std::int64_t TableParts::row_bytes() const {
  return std::accumulate(bands_.begin(), bands_.end(), std::int64_t{0},
                         [](std::int64_t sum, const Band& band) { return sum + std::max(band.stride, band.width); });
}

PointTable TableParts::read(exec::Cpu& /*ex*/, std::int64_t first, std::int64_t count, Bytes& buffer) const {
  std::size_t size = 0;
  for (const Band& band : bands_) size += span_bytes(count, band.stride, band.width);
  buffer.resize(size);
  PointTable part = table_;
  part.rows = count;
  const char* const start = input_.source().bytes.data();
  char* to = buffer.data();
  for (const Band& band : bands_) {
    const std::size_t bytes = span_bytes(count, band.stride, band.width);
    input_.read_at(band.at + static_cast<std::size_t>(first * band.stride), bytes, to);
    for (const std::size_t c : band.columns)
      part.columns[c].data =
          behind(to, static_cast<std::size_t>(table_.columns[c].data - start - static_cast<std::ptrdiff_t>(band.at)));
    to += bytes;
  }
  return part;
}

}  // namespace pointskin::io
