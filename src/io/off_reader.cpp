// OFF (Geomview object file format), text, with the prefixes N (normals) and C (colours) and ST (texture, passed over).
#include <array>

#include "core/format.hpp"
#include "io/lines.hpp"
#include "io/parsed_columns.hpp"
#include "io/polygon.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

constexpr const char* kAdvice = "export the file again";

struct OffHeader {
  bool has_normals = false, has_colours = false;
  std::int64_t rows = 0;  ///< rows of the header itself
  std::int64_t vertices = 0, faces = 0;
};

/// Reads the keyword. @returns false if `word` is none
bool take_keyword(std::string_view word, OffHeader& header) {
  if (word.starts_with("ST")) word.remove_prefix(2);
  if (word.starts_with("C")) {
    header.has_colours = true;
    word.remove_prefix(1);
  }
  if (word.starts_with("N")) {
    header.has_normals = true;
    word.remove_prefix(1);
  }
  return word == "OFF";
}

/// The counts may stand on the keyword's line or on the next.
OffHeader parse_header(const Source& source, std::string_view text) {
  OffHeader header;
  std::array<std::int64_t, 3> counts{};
  std::size_t known = 0;
  Line line;
  for_each_line(text, [&](std::string_view line_text) {
    ++line.number;
    line.text = line_text;
    if (!is_row(line_text)) return true;
    Values values(source, line);
    if (header.rows == 0 && !take_keyword(values.word(), header))
      fail_at_line(source, "is no OFF file that can be read, its first word is not OFF", line.number,
                   "convert it to text OFF");
    if (header.rows++ > 0 || !values.at_end())
      while (known < 2 || (known < 3 && !values.at_end())) {
        counts[known] = values.whole();
        if (counts[known++] < 0) fail_at_line(source, "a count is negative", line.number, kAdvice);
      }
    return known == 0;
  });
  if (known == 0) fail_at_line(source, "the counts are missing", line.number, kAdvice);
  header.vertices = counts[0];
  header.faces = counts[1];
  return header;
}

/// Compares the promises with what the file can hold: 3 values of 2 bytes a vertex, one value a face.
void check_counts(const Source& source, const OffHeader& header, std::int64_t rows) {
  const std::uint64_t bytes = source.bytes.size() + 1;
  const auto vertices = static_cast<std::uint64_t>(header.vertices);
  const auto faces = static_cast<std::uint64_t>(header.faces);
  const std::uint64_t each = header.has_normals ? 12 : 6;
  if (!fits(vertices, each, bytes) || !fits(faces, 2, bytes - vertices * each) ||
      header.vertices + header.faces > rows - header.rows)
    fail_at_byte(source,
                 fmt::format("is truncated, {} vertices and {} faces are promised but {} lines follow", header.vertices,
                             header.faces, rows - header.rows),
                 source.bytes.size(), "copy or export the file again");
}

/// Colours follow as 3 or 4 values; bytes or shares of one. Without colours, or with a colour map's index, none.
std::size_t colour_columns(exec::Cpu& ex, const Source& source, const LineIndex& index, const OffHeader& header) {
  std::size_t values_left = 0;
  for_each_row(ex, index, header.rows, header.rows + 1, [&](const Line& line, std::size_t) {
    Values values(source, line);
    for (int i = header.has_normals ? 6 : 3; i > 0; --i) values.number();
    while (!values.at_end()) {
      values.number();
      ++values_left;
    }
  });
  return header.has_colours && (values_left == 3 || values_left == 4) ? values_left : 0;
}

ParsedColumns parse_vertices(exec::Cpu& ex, const Source& source, const LineIndex& index, const OffHeader& header) {
  ParsedColumns parsed;
  for (const char* axis : {"x", "y", "z"}) parsed.add(axis, AttributeType::float64);
  if (header.has_normals)
    for (const char* axis : {"nx", "ny", "nz"}) parsed.add(axis, AttributeType::float32);
  const std::size_t first_colour = parsed.size();
  constexpr std::array kColours{"red", "green", "blue", "alpha"};
  const std::size_t colours = header.vertices > 0 ? colour_columns(ex, source, index, header) : 0;
  for (std::size_t c = 0; c < colours; ++c) parsed.add(kColours[c], AttributeType::float32);
  parsed.allocate(header.vertices);
  for_each_row(ex, index, header.rows, header.rows + header.vertices, [&](const Line& line, std::size_t) {
    Values values(source, line);
    for (std::size_t c = 0; c < parsed.size(); ++c) parsed.set(c, line.row - header.rows, values.number());
  });
  bool bytes = true;
  bool over_one = false;
  for (std::size_t c = first_colour; c < parsed.size(); ++c) {
    bytes = bytes && parsed.holds_bytes(c);
    over_one = over_one || parsed.exceeds(c, 1);
  }
  for (std::size_t c = first_colour; c < parsed.size() && bytes && over_one; ++c)
    parsed.redeclare(c, kColours[c - first_colour], AttributeType::uint8);
  return parsed;
}

std::vector<Triangle> parse_faces(exec::Cpu& ex, const Source& source, const LineIndex& index,
                                  const OffHeader& header) {
  std::vector<std::vector<Triangle>> parts(index.blocks.size());
  const std::int64_t first = header.rows + header.vertices;
  for_each_row(ex, index, first, first + header.faces, [&](const Line& line, std::size_t block) {
    Values values(source, line);
    std::vector<std::int32_t> corners;
    for (std::int64_t i = values.whole(); i > 0; --i) {
      const std::int64_t id = values.whole();
      if (id < 0 || id >= header.vertices)
        fail_at_line(source, fmt::format("a face names vertex {}, but there are {}", id, header.vertices), line.number,
                     kAdvice);
      corners.push_back(static_cast<std::int32_t>(id));
    }
    append_fan(corners, parts[block]);
  });
  return concatenate(std::move(parts));
}

}  // namespace

bool looks_like_off(std::string_view bytes, bool /*want_mesh*/) {
  const std::string_view text = without_byte_order_mark(bytes);
  OffHeader header;
  return take_keyword(text.substr(0, text.find_first_of(" \t\r\n")), header);
}

Mesh parse_off(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const std::string_view text = without_byte_order_mark(source.bytes);
  const OffHeader header = parse_header(source, text);
  check_vertex_count(source, header.vertices);
  const LineIndex index = index_lines(ex, text);
  check_counts(source, header, index.rows);
  const ParsedColumns parsed = parse_vertices(ex, source, index, header);
  return assemble_mesh(ex, source, parsed.table(), parse_faces(ex, source, index, header), options);
}

}  // namespace pointskin::io
