#include "io/text_parts.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "io/ply_row.hpp"
#include "io/scalar.hpp"
#include "io/text_columns.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kIndexedAtOnce = std::size_t{8} << 20;  // bytes, which are in memory meanwhile

Column stored_as_double(std::string name, AttributeType declared) {
  Column column;
  column.name = std::move(name);
  column.declared = declared;
  return column;
}

/// What was cut off while it was read looks like a mistake in the text: that it was cut is what is told.
template <class Read>
void read_whole_lines(const Input& input, const Read& read) {
  try {
    read();
  } catch (const Error&) {
    input.check_whole();
    throw;
  }
  input.check_whole();
}

/// The first lines of a text, about kIndexedAtOnce bytes.
std::string_view first_part(std::string_view text) {
  if (text.size() <= kIndexedAtOnce) return text;
  const std::size_t border = text.find('\n', kIndexedAtOnce - 1);
  return text.substr(0, border == std::string_view::npos ? text.size() : border + 1);
}

/// Counts the lines of `text`, a part at a time, and calls use(the index of the part) before its pages are given back.
template <class Use>
LineIndex index_in_parts(exec::Cpu& ex, const Input& input, std::string_view text, std::int64_t first_line,
                         const Use& use) {
  LineIndex all;
  all.end_line = first_line;
  read_whole_lines(input, [&] {
    while (!text.empty()) {
      const std::string_view part = first_part(text);
      const LineIndex index = index_lines(ex, part, all.end_line, all.rows);
      use(index);
      all.blocks.insert(all.blocks.end(), index.blocks.begin(), index.blocks.end());
      all.rows = index.rows;
      all.end_line = index.end_line;
      input.release(part);
      text.remove_prefix(part.size());
    }
  });
  return all;
}

}  // namespace

std::unique_ptr<TextParts> TextParts::of_columns(exec::Cpu& ex, const Input& input) {
  const Source source = input.source();
  const TextLayout layout = find_layout(source);
  (void)column_names(source, layout);  // refuses what cannot be before all is read
  const auto read_row = [columns = layout.columns](Values& values, const SetValue& set) {
    for (std::size_t c = 0; c < columns; ++c) set(c, values.number());
    values.expect_end();
  };
  std::unique_ptr<TextParts> parts(new TextParts(input, read_row));
  SeenValues seen(layout);
  const SetValue see = [&](std::size_t column, double value) { seen.see(column, value); };
  parts->index_ = index_in_parts(ex, input, without_byte_order_mark(source.bytes), 1, [&](const LineIndex& index) {
    for_each_row(ex, index, layout.header_rows, index.rows, [&](const Line& line, std::size_t) {
      Values values(source, line);
      read_row(values, see);
    });
  });
  parts->first_row_ = layout.header_rows;
  parts->rows_ = parts->index_.rows - layout.header_rows;
  check_rows(source, layout, parts->rows_);
  for (TextColumn& column : describe_columns(source, layout, seen))
    parts->table_.columns.push_back(stored_as_double(std::move(column.name), column.type));
  return parts;
}

std::unique_ptr<TextParts> TextParts::of_ply(exec::Cpu& ex, const Input& input, const PlyHeader& header) {
  const Source source = input.source();
  const PlyElement& vertex = *header.find("vertex");
  std::unique_ptr<TextParts> parts(
      new TextParts(input, [vertex](Values& values, const SetValue& set) { read_scalars(values, vertex, set); }));
  parts->index_ =
      index_in_parts(ex, input, source.bytes.substr(header.body), header.body_line, [](const LineIndex&) {});
  std::int64_t row = 0;
  for (const PlyElement& element : header.elements) {
    check_lines(source, element, parts->index_.rows - row);
    if (&element == &vertex) parts->first_row_ = row;
    row += lines_of(element);
  }
  parts->rows_ = lines_of(vertex);
  for (const PlyProperty& property : vertex.properties)
    if (!property.is_list) parts->table_.columns.push_back(stored_as_double(property.name, property.type));
  return parts;
}

std::int64_t TextParts::row_bytes() const {
  const auto text = static_cast<std::int64_t>(input_.source().bytes.size());
  return text / std::max<std::int64_t>(1, rows_) + static_cast<std::int64_t>(sizeof(double) * table_.columns.size());
}

PointTable TextParts::read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const {
  const Source source = input_.source();
  const std::int64_t begin = first_row_ + first;
  const std::size_t row_bytes = sizeof(double) * table_.columns.size();
  buffer.resize(static_cast<std::size_t>(count) * row_bytes);
  const LineIndex index = blocks_of_rows(index_, begin, begin + count);
  read_whole_lines(input_, [&] {
    for_each_row(ex, index, begin, begin + count, [&](const Line& line, std::size_t) {
      Values values(source, line);
      char* const row = buffer.data() + static_cast<std::size_t>(line.row - begin) * row_bytes;
      read_row_(values, [&](std::size_t column, double value) {
        std::memcpy(row + sizeof(double) * column, &value, sizeof value);
      });
    });
  });
  for (const LineBlock& block : index.blocks) input_.release(block.text);
  PointTable table = table_;
  table.rows = count;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    table.columns[c].data = behind(buffer.data(), sizeof(double) * c);
    table.columns[c].stride_bytes = static_cast<std::int64_t>(row_bytes);
  }
  return table;
}

}  // namespace pointskin::io
