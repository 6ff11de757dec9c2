// STL, binary and text. Corners with the same coordinates become one vertex, numbered by first appearance.
#include <pointskin/error.hpp>

#include <array>
#include <bit>
#include <limits>

#include "core/format.hpp"
#include "io/lines.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;
constexpr std::size_t kNormalBytes = 12;

struct Welded {
  std::vector<Vec3d> vertices;
  std::vector<Triangle> triangles;
};

/// Finds equal corners with an open-addressing hash table of vertex ids; one pass in file order.
class Welder {
 public:
  explicit Welder(std::size_t corners) : slots_(std::bit_ceil(corners / 2 + 16), -1) {}

  std::int32_t id_of(Vec3d corner) {
    corner += Vec3d{0, 0, 0};  // -0 and 0 are the same place
    if (2 * (vertices_.size() + 1) > slots_.size()) grow();
    const std::size_t slot = slot_of(corner);
    if (slots_[slot] < 0) {
      if (vertices_.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
        throw Error(ErrorCode::over_limit, "the STL file has more than 2147483647 vertices; split it");
      slots_[slot] = static_cast<std::int32_t>(vertices_.size());
      vertices_.push_back(corner);
    }
    return slots_[slot];
  }

  std::vector<Vec3d> take_vertices() { return std::move(vertices_); }

 private:
  [[nodiscard]] std::size_t slot_of(const Vec3d& corner) const {
    const auto bits = std::bit_cast<std::array<std::uint64_t, 3>>(corner);
    std::uint64_t hash = 0;
    for (const std::uint64_t b : bits) {
      hash = (hash ^ b) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    std::size_t slot = hash & (slots_.size() - 1);
    while (slots_[slot] >= 0 &&
           std::bit_cast<std::array<std::uint64_t, 3>>(vertices_[static_cast<std::size_t>(slots_[slot])]) != bits)
      slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), -1);
    for (std::size_t v = 0; v < vertices_.size(); ++v) slots_[slot_of(vertices_[v])] = static_cast<std::int32_t>(v);
  }

  std::vector<std::int32_t> slots_;  ///< a power of two, at most half full
  std::vector<Vec3d> vertices_;
};

/// @param corner  gives the position of corner i
template <class Corner>
Welded weld(std::size_t triangles, const Corner& corner) {
  Welded result;
  Welder welder(triangles);
  result.triangles.reserve(triangles);
  for (std::size_t t = 0; t < triangles; ++t)
    result.triangles.push_back(
        {welder.id_of(corner(3 * t)), welder.id_of(corner(3 * t + 1)), welder.id_of(corner(3 * t + 2))});
  result.vertices = welder.take_vertices();
  return result;
}

std::uint32_t promised_triangles(std::string_view bytes) {
  return load<std::uint32_t>(bytes.data() + kHeaderBytes - 4, false);
}

/// Text STL starts with "solid", but so do some binary files: there the length decides.
bool is_binary(std::string_view bytes) {
  if (bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + kTriangleBytes * promised_triangles(bytes))
    return true;
  return !without_byte_order_mark(bytes).starts_with("solid");
}

Welded parse_binary(const Source& source) {
  const std::string_view bytes = source.bytes;
  if (bytes.size() < kHeaderBytes)
    fail_at_byte(source, "is no STL file, it ends in the header", bytes.size(), "copy or export the file again");
  const std::uint32_t triangles = promised_triangles(bytes);
  if (!fits(triangles, kTriangleBytes, bytes.size() - kHeaderBytes))
    fail_at_byte(source, fmt::format("is truncated, {} triangles are promised", triangles), bytes.size(),
                 "copy or export the file again");
  return weld(triangles, [&](std::size_t i) {
    const char* at = bytes.data() + kHeaderBytes + i / 3 * kTriangleBytes + kNormalBytes + i % 3 * 3 * sizeof(float);
    return Vec3d{load<float>(at, false), load<float>(at + 4, false), load<float>(at + 8, false)};
  });
}

/// What a block of a text STL holds.
struct TextBlock {
  std::vector<Vec3d> corners;
  std::int64_t facets = 0;
  bool ends = false;  ///< the last row is "endsolid"
};

void parse_text_line(const Source& source, const Line& line, TextBlock& block) {
  Values values(source, line);
  const std::string_view word = values.word();
  block.ends = word == "endsolid";
  if (word == "vertex") {
    block.corners.push_back({values.number(), values.number(), values.number()});
    values.expect_end();
  } else if (word == "facet") {
    ++block.facets;
  } else if (word != "solid" && word != "outer" && word != "endloop" && word != "endfacet" && word != "endsolid") {
    fail_at_line(source, "the word " + in_quotes(word) + " does not belong into STL", line.number,
                 "export the file again");
  }
}

Welded parse_text_stl(exec::Cpu& ex, const Source& source) {
  const LineIndex index = index_lines(ex, without_byte_order_mark(source.bytes));
  std::vector<TextBlock> blocks(index.blocks.size());
  for_each_row(ex, index, 0, index.rows,
               [&](const Line& line, std::size_t b) { parse_text_line(source, line, blocks[b]); });
  std::vector<std::vector<Vec3d>> parts;
  std::size_t facets = 0;
  bool ends = false;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto block = static_cast<std::int64_t>(b);
    if (index.rows_before(block + 1) > index.rows_before(block)) ends = blocks[b].ends;
    facets += static_cast<std::size_t>(blocks[b].facets);
    parts.push_back(std::move(blocks[b].corners));
  }
  const std::vector<Vec3d> corners = concatenate(std::move(parts));
  if (!ends || corners.size() != 3 * facets)
    fail_at_byte(source,
                 fmt::format("is truncated or garbled, {} facets have {} corners{}", facets, corners.size(),
                             ends ? "" : " and endsolid is missing"),
                 source.bytes.size(), "copy or export the file again");
  return weld(facets, [&](std::size_t i) { return corners[i]; });
}

}  // namespace

bool looks_like_stl(std::string_view bytes, bool /*want_mesh*/) {
  if (without_byte_order_mark(bytes).starts_with("solid")) return true;
  return bytes.size() >= kHeaderBytes && is_binary(bytes) &&
         bytes.size() == kHeaderBytes + kTriangleBytes * promised_triangles(bytes);
}

Mesh parse_stl(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const bool binary = is_binary(source.bytes);
  Welded mesh = binary ? parse_binary(source) : parse_text_stl(ex, source);
  PointTable table{static_cast<std::int64_t>(mesh.vertices.size()), {}};
  const char* data = reinterpret_cast<const char*>(mesh.vertices.data());
  for (const char* axis : {"x", "y", "z"}) {
    table.columns.push_back({axis, binary ? AttributeType::float32 : AttributeType::float64, AttributeType::float64,
                             data, sizeof(Vec3d), false});
    if (data != nullptr) data += sizeof(double);  // a file without triangles has no vertices
  }
  return assemble_mesh(ex, source, table, std::move(mesh.triangles), options);
}

}  // namespace pointskin::io
