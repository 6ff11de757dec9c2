// XYZ, PTS, ASC, TXT and CSV: one point a line.
#include <pointskin/formats.hpp>

#include <string>
#include <vector>

#include "io/lines.hpp"
#include "io/parsed_columns.hpp"
#include "io/readers.hpp"
#include "io/text_columns.hpp"

namespace pointskin::io {
namespace {

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

/// Gives columns the names and types that their values ask for. Few files hold numbers that float does not: those are read
/// again, so that the others do not take the memory of doubles.
/// @returns which columns are to be read again; empty: none
std::vector<bool> describe(const std::vector<TextColumn>& columns, const SeenValues& seen, ParsedColumns& parsed) {
  std::vector<bool> wide;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    parsed.redeclare(c, columns[c].name, columns[c].type);
    if (!seen.may_be_scalar(c) || columns[c].type == AttributeType::uint8 || !seen.exceed_float(c)) continue;
    parsed.store_as(c, columns[c].type);
    wide.resize(columns.size());
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
  check_rows(source, layout, rows);
  ParsedColumns parsed;
  for (const std::string& name : column_names(source, layout)) parsed.add(name, AttributeType::float32);
  parsed.allocate(rows);
  SeenValues seen(layout);
  for_each_value(ex, source, index, layout, [&](std::size_t column, std::int64_t row, double value) {
    parsed.set(column, row, value);
    seen.see(column, value);
  });
  if (const std::vector<bool> wide = describe(describe_columns(source, layout, seen), seen, parsed); !wide.empty())
    for_each_value(ex, source, index, layout, [&](std::size_t column, std::int64_t row, double value) {
      if (wide[column]) parsed.set(column, row, value);
    });
  return assemble(ex, source, parsed.table(), options.shift);
}

}  // namespace pointskin::io
