// XYZ, PTS, ASC, TXT and CSV: one point a line.
#include <pointskin/formats.hpp>

#include <algorithm>
#include <vector>

#include "core/format.hpp"
#include "io/lines.hpp"
#include "io/readers.hpp"
#include "io/text_columns.hpp"

namespace pointskin::io {
namespace {

void check_count(const Source& source, const TextLayout& layout, std::int64_t rows) {
  if (layout.promised >= 0 && layout.promised != rows)
    fail_at_line(source, fmt::format("the first line promises {} points, but {} follow", layout.promised, rows), 1,
                 "copy the file again or correct its first line");
  // Memory is taken for what the first point has, so the other lines must be able to hold as much. In small files the
  // parser finds the line to blame.
  constexpr std::size_t kSmall = std::size_t{1} << 20;
  if (!fits(static_cast<std::uint64_t>(rows), 2 * layout.columns, std::max(kSmall, source.bytes.size() + 1)))
    fail_at_line(source, fmt::format("most lines have fewer values than the {} of this one", layout.columns),
                 layout.first_line, "export the file again");
}

/// Calls f(column, row, value) for every value, rows in parallel.
template <class F>
void for_each_value(exec::Cpu& ex, const Source& source, const LineIndex& index, const TextLayout& layout, const F& f) {
  for_each_row(ex, index, layout.header_rows, index.rows, [&](const Line& line, std::size_t) {
    Values values(source, line);
    const std::int64_t row = line.row - layout.header_rows;
    for (std::size_t c = 0; c < layout.columns; ++c) f(c, row, values.number());
    values.expect_end();
  });
}

/// Declares the types of attributes that are no colours. Few files hold numbers that float does not: those are read
/// again, so that the others do not take the memory of doubles.
/// @returns which columns are to be read again; empty: none
std::vector<bool> type_attributes(const NeededTypes& needed, ParsedColumns& parsed) {
  std::vector<bool> wide;
  for (std::size_t c = 0; c < parsed.size(); ++c) {
    if (!needed.is_looked_at(c) || parsed.declared(c) != AttributeType::float32) continue;
    const AttributeType type = needed.type_of(c);
    parsed.redeclare(c, parsed.name(c), type);
    if (!needed.exceeds_float(c)) continue;
    parsed.store_as(c, type);
    wide.resize(parsed.size());
    wide[c] = true;
  }
  return wide;
}

}  // namespace

Cloud parse_text(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  if (extension_of(source.name) == ".xyz" && is_binary_xyz(source)) return parse_binary_xyz(ex, source, options);
  const TextLayout layout = find_layout(source);
  const LineIndex index = index_lines(ex, without_byte_order_mark(source.bytes));
  const std::int64_t rows = index.rows - layout.header_rows;
  check_count(source, layout, rows);
  ParsedColumns parsed;
  add_columns(source, layout, parsed);
  parsed.allocate(rows);
  NeededTypes needed(layout);
  for_each_value(ex, source, index, layout, [&](std::size_t column, std::int64_t row, double value) {
    parsed.set(column, row, value);
    needed.see(column, value);
  });
  name_columns(source, layout, parsed);
  if (const std::vector<bool> wide = type_attributes(needed, parsed); !wide.empty())
    for_each_value(ex, source, index, layout, [&](std::size_t column, std::int64_t row, double value) {
      if (wide[column]) parsed.set(column, row, value);
    });
  return assemble(ex, source, parsed.table(), options.shift);
}

}  // namespace pointskin::io
