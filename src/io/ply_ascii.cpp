// Text bodies: one row a line, blank lines and comments between them skipped.
#include <algorithm>
#include <limits>

#include "core/format.hpp"
#include "io/lines.hpp"
#include "io/ply_body.hpp"
#include "io/ply_row.hpp"
#include "io/polygon.hpp"

namespace pointskin::io {
namespace {

/// Where an element lies.
struct RowRange {
  std::int64_t first, last;
};

}  // namespace

double read_scalar(Values& values, const PlyProperty& property) {
  if (!is_integer(property.type)) return values.number();
  Values before = values;
  const double value = values.number();
  visit_type(property.type, [&](auto tag) {
    constexpr auto kLowest = std::numeric_limits<decltype(tag)>::lowest();
    constexpr auto kHighest = std::numeric_limits<decltype(tag)>::max();
    if (value >= static_cast<double>(kLowest) && value <= static_cast<double>(kHighest) && value == std::floor(value))
      return;
    before.at_end();
    before.fail_garbled(fmt::format("does not fit into a property {}, which holds whole numbers in {}..{}",
                                    ply_name_of(property.type), kLowest, kHighest)
                            .c_str());
  });
  return value;
}

std::int64_t read_list_length(Values& values) {
  Values before = values;
  const std::int64_t length = values.whole();
  if (length < 0) {
    before.at_end();
    before.fail_garbled("is a negative list length");
  }
  return length;
}

void check_lines(const Source& source, const PlyElement& element, std::int64_t lines) {
  if (lines < lines_of(element))
    fail_at_byte(source,
                 fmt::format("is truncated, element {} promises {} rows but {} are left", in_quotes(element.name),
                             element.count, lines),
                 source.bytes.size(), "copy or export the file again");
}

namespace {

void read_vertices(exec::Cpu& ex, const PlyInput& input, const PlyElement& vertex, const LineIndex& index,
                   const RowRange& range, PlyBody& body) {
  add_scalars(vertex, body.parsed);
  for_each_row(ex, index, range.first, range.last, [&](const Line& line, std::size_t) {
    Values values(input.source, line);
    read_scalars(values, vertex,
                 [&](std::size_t column, double value) { body.parsed.set(column, line.row - range.first, value); });
  });
  body.vertices = body.parsed.table();
}

std::int32_t corner_of(Values& values, std::int64_t vertices) {
  Values before = values;
  const std::int64_t index = values.whole();
  if (index < 0 || index >= vertices) {
    before.at_end();
    before.fail_garbled(fmt::format("is no vertex, there are {}", vertices).c_str());
  }
  return static_cast<std::int32_t>(index);
}

void read_faces(exec::Cpu& ex, const PlyInput& input, const PlyElement& face, const LineIndex& index,
                const RowRange& range, PlyBody& body) {
  const std::size_t list = find_corner_list(input.source, face);
  const std::int64_t vertices = vertex_count(input.header);
  std::vector<std::vector<Triangle>> parts(index.blocks.size());
  for_each_row(ex, index, range.first, range.last, [&](const Line& line, std::size_t block) {
    Values values(input.source, line);
    std::vector<std::int32_t> corners;
    for (std::size_t p = 0; p < face.properties.size(); ++p) {
      const std::int64_t count = face.properties[p].is_list ? read_list_length(values) : 1;
      for (std::int64_t i = 0; i < count; ++i) {
        if (p == list)
          corners.push_back(corner_of(values, vertices));
        else
          values.number();
      }
    }
    values.expect_end();
    append_fan(corners, parts[block]);
  });
  body.triangles = concatenate(std::move(parts));
}

}  // namespace

void read_ascii_body(exec::Cpu& ex, const PlyInput& input, PlyBody& body) {
  const LineIndex index = index_lines(ex, input.source.bytes.substr(input.header.body), input.header.body_line);
  RowRange range{0, 0};
  for (const PlyElement& element : input.header.elements) {
    range.last = range.first + lines_of(element);
    check_lines(input.source, element, index.rows - range.first);
    if (element.name == "vertex" && !element.properties.empty())
      read_vertices(ex, input, element, index, range, body);
    else if (element.name == "face" && input.want_faces && element.count > 0)
      read_faces(ex, input, element, index, range, body);
    range.first = range.last;
  }
}

}  // namespace pointskin::io
