// XYZ, PTS, ASC, TXT and CSV: one point a line.
#include <fmt/format.h>

#include <algorithm>

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

}  // namespace

Cloud parse_text(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const TextLayout layout = find_layout(source);
  const LineIndex index = index_lines(ex, without_byte_order_mark(source.bytes));
  const std::int64_t rows = index.rows - layout.header_rows;
  check_count(source, layout, rows);
  ParsedColumns parsed;
  add_columns(source, layout, parsed);
  parsed.allocate(rows);
  for_each_row(ex, index, layout.header_rows, index.rows, [&](const Line& line, std::size_t) {
    Values values(source, line);
    const std::int64_t row = line.row - layout.header_rows;
    for (std::size_t c = 0; c < layout.columns; ++c) parsed.set(c, row, values.number());
    values.expect_end();
  });
  name_columns(source, layout, parsed);
  return assemble(ex, source, parsed.table(), options.shift);
}

}  // namespace pointskin::io
