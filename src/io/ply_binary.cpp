// Binary bodies. Rows without lists lie at equal distances and are read in parallel; rows with lists are walked one
// by one, except for the common case that every face is a triangle, which is verified and then read in parallel.
#include <algorithm>
#include <atomic>
#include <optional>

#include "core/format.hpp"
#include "exec/host_array.hpp"
#include "io/blocks.hpp"
#include "io/ply_body.hpp"
#include "io/ply_triangle_rows.hpp"
#include "io/polygon.hpp"

namespace pointskin::io {
namespace {

constexpr std::int64_t kBlockRows = 1 << 14;
constexpr const char* kCopyAgain = "copy or export the file again";

/// Walks the rows of an element with lists.
class RowWalker {
 public:
  RowWalker(const PlyInput& input, const PlyElement& element, std::size_t at)
      : input_(input), element_(element), at_(at), slots_(element.properties.size()) {}

  /// Moves to the next row. @throws Error invalid_input if the file ends in it
  void next() {
    for (std::size_t p = 0; p < slots_.size(); ++p) {
      const PlyProperty& property = element_.properties[p];
      std::int64_t count = 1;
      if (property.is_list) {
        const char* length = take(1, size_of(property.count_type));
        count = load_integer(property.count_type, length, swapped());
        if (count < 0) fail_here("a list has a negative length");
      }
      slots_[p] = {take(count, size_of(property.type)), count};
    }
    ++row_;
  }

  [[nodiscard]] const char* data(std::size_t property) const { return slots_[property].data; }
  [[nodiscard]] std::int64_t count(std::size_t property) const { return slots_[property].count; }
  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] bool swapped() const { return input_.header.encoding == PlyEncoding::big_endian; }

  [[noreturn]] void fail_here(const std::string& what) const {
    fail_at_byte(input_.source, fmt::format("{} in row {} of element {}", what, row_, in_quotes(element_.name)), at_,
                 kCopyAgain);
  }

 private:
  struct Slot {
    const char* data;
    std::int64_t count;
  };

  const char* take(std::int64_t count, std::size_t each) {
    if (!fits(static_cast<std::uint64_t>(count), each, input_.source.bytes.size() - at_)) fail_here("the file ends");
    const char* data = input_.source.bytes.data() + at_;
    at_ += static_cast<std::size_t>(count) * each;
    return data;
  }

  const PlyInput& input_;
  const PlyElement& element_;
  std::size_t at_;
  std::int64_t row_ = 0;
  std::vector<Slot> slots_;
};

/// @returns the byte after `element`, whose rows all have `row_bytes`
std::size_t skip_fixed(const PlyInput& input, const PlyElement& element, std::size_t at, std::size_t row_bytes) {
  const std::size_t left = input.source.bytes.size() - at;
  if (!fits(static_cast<std::uint64_t>(element.count), row_bytes, left))
    fail_at_byte(input.source, fmt::format("the file ends in element {}", in_quotes(element.name)),
                 input.source.bytes.size(), kCopyAgain);
  return at + static_cast<std::size_t>(element.count) * row_bytes;
}

std::size_t skip_element(const PlyInput& input, const PlyElement& element, std::size_t at) {
  if (!element.has_lists()) return skip_fixed(input, element, at, element.smallest_row_bytes());
  RowWalker walker(input, element, at);
  for (std::int64_t row = 0; row < element.count; ++row) walker.next();
  return walker.at();
}

std::size_t view_vertices(const PlyInput& input, const PlyElement& element, std::size_t at, PlyBody& body) {
  const std::size_t end = skip_fixed(input, element, at, element.smallest_row_bytes());
  body.vertices = view_rows(element, input.header.encoding, input.source.bytes.data() + at, element.count);
  return end;
}

std::size_t copy_vertices(const PlyInput& input, const PlyElement& element, std::size_t at, PlyBody& body) {
  add_scalars(element, body.parsed);
  RowWalker walker(input, element, at);
  for (std::int64_t row = 0; row < element.count; ++row) {
    walker.next();
    std::size_t column = 0;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (element.properties[p].is_list) continue;
      visit_type(element.properties[p].type, [&](auto tag) {
        const auto value = load<decltype(tag)>(walker.data(p), walker.swapped());
        body.parsed.set(column++, row, static_cast<double>(value));
      });
    }
  }
  body.vertices = body.parsed.table();
  return walker.at();
}

/// The rows of the faces at byte `at`, if all are triangles, which checking every row at its place proves.
std::optional<TriangleRows> find_triangle_rows(exec::Cpu& ex, const PlyInput& input, const PlyElement& face,
                                               std::size_t list, std::size_t at) {
  const std::optional<TriangleRows> rows = triangle_rows_of(face, list, input.header.encoding);
  if (!rows || !fits(static_cast<std::uint64_t>(face.count), rows->row_bytes, input.source.bytes.size() - at))
    return std::nullopt;
  const char* data = input.source.bytes.data() + at;
  std::atomic<bool> all_three{true};
  run_in_order(ex, (face.count + kBlockRows - 1) / kBlockRows, [&](std::int64_t b) {
    const std::int64_t first = b * kBlockRows;
    const std::int64_t count = std::min(face.count - first, kBlockRows);
    if (all_three && !rows->are_triangles(data + static_cast<std::size_t>(first) * rows->row_bytes, count))
      all_three = false;
  });
  return all_three ? rows : std::nullopt;
}

void read_triangle_rows(exec::Cpu& ex, const PlyInput& input, const PlyElement& face, const TriangleRows& rows,
                        std::size_t at, std::vector<Triangle>& triangles) {
  exec::resize_to_overwrite(ex, triangles, static_cast<std::size_t>(face.count));
  const std::int64_t vertices = vertex_count(input.header);
  run_in_order(ex, (face.count + kBlockRows - 1) / kBlockRows, [&](std::int64_t b) {
    const std::int64_t first = b * kBlockRows;
    const char* data = input.source.bytes.data() + at + static_cast<std::size_t>(first) * rows.row_bytes;
    const char* bad = rows.read(data, std::min(face.count - first, kBlockRows), vertices, triangles.data() + first);
    if (bad != nullptr)
      fail_on_corner(input.source, load_integer(rows.type, bad, rows.swapped), vertices,
                     static_cast<std::size_t>(bad - input.source.bytes.data()));
  });
}

std::size_t read_faces(exec::Cpu& ex, const PlyInput& input, const PlyElement& face, std::size_t at,
                       std::vector<Triangle>& triangles) {
  const std::size_t list = find_corner_list(input.source, face);
  const AttributeType type = face.properties[list].type;
  if (const auto rows = find_triangle_rows(ex, input, face, list, at)) {
    read_triangle_rows(ex, input, face, *rows, at, triangles);
    return at + static_cast<std::size_t>(face.count) * rows->row_bytes;
  }
  const std::int64_t vertices = vertex_count(input.header);
  std::vector<std::int32_t> corners;
  RowWalker walker(input, face, at);
  for (std::int64_t row = 0; row < face.count; ++row) {
    walker.next();
    corners.clear();
    for (std::int64_t c = 0; c < walker.count(list); ++c) {
      const char* from = walker.data(list) + static_cast<std::size_t>(c) * size_of(type);
      const std::int64_t index = load_integer(type, from, walker.swapped());
      if (index < 0 || index >= vertices)
        fail_on_corner(input.source, index, vertices, static_cast<std::size_t>(from - input.source.bytes.data()));
      corners.push_back(static_cast<std::int32_t>(index));
    }
    append_fan(corners, triangles);
  }
  return walker.at();
}

}  // namespace

void fail_on_corner(const Source& source, std::int64_t index, std::int64_t vertices, std::size_t byte) {
  fail_at_byte(source, fmt::format("a face names vertex {}, but there are {}", index, vertices), byte, kCopyAgain);
}

PointTable view_rows(const PlyElement& element, PlyEncoding encoding, const char* data, std::int64_t rows) {
  PointTable table;
  table.rows = rows;
  const auto row_bytes = static_cast<std::int64_t>(element.smallest_row_bytes());
  for (const PlyProperty& p : element.properties) {
    table.columns.push_back({p.name, p.type, p.type, data, row_bytes, encoding == PlyEncoding::big_endian});
    data += size_of(p.type);
  }
  return table;
}

void read_binary_body(exec::Cpu& ex, const PlyInput& input, PlyBody& body) {
  std::size_t at = input.header.body;
  for (const PlyElement& element : input.header.elements) {
    if (element.name == "vertex")
      at = element.has_lists() ? copy_vertices(input, element, at, body) : view_vertices(input, element, at, body);
    else if (element.name == "face" && input.want_faces && element.count > 0)
      at = read_faces(ex, input, element, at, body.triangles);
    else
      at = skip_element(input, element, at);
  }
}

}  // namespace pointskin::io
