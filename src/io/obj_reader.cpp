// Wavefront OBJ: vertices, vertex normals and polygons; everything else is passed over. Three numbers behind the
// coordinates of every vertex are its colour, as many programs write it, though the format does not have it.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>

#include "core/format.hpp"
#include "io/lines.hpp"
#include "io/parsed_columns.hpp"
#include "io/polygon.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

struct Counts {
  std::int64_t vertices = 0, normals = 0;
};

/// Per block: what comes before it, and what it holds.
struct ObjBlock {
  Counts before;
  Counts seen;  ///< so far, while the block is parsed
  std::vector<Triangle> triangles;
  bool normals_match = true;  ///< every corner that names a normal names that of its vertex
  bool coloured = true;       ///< every vertex has a colour, or nothing is known of that
};

enum class Keyword { vertex, normal, face, other };

Keyword keyword_of(std::string_view word) {
  if (word == "v") return Keyword::vertex;
  if (word == "vn") return Keyword::normal;
  return word == "f" ? Keyword::face : Keyword::other;
}

class ObjParser {
 public:
  ObjParser(exec::Cpu& ex, const Source& source)
      : ex_(ex), source_(source), index_(index_lines(ex, without_byte_order_mark(source.bytes))) {}

  Mesh parse(const ReadOptions& options) {
    count();
    if (total_.vertices == 0) fail(source_, "holds no vertices", "check that it is an OBJ file");
    check_vertex_count(source_, total_.vertices);
    for (const char* axis : {"x", "y", "z"}) parsed_.add(axis, AttributeType::float64);
    if (total_.normals == total_.vertices) add_columns({"nx", "ny", "nz"}, normal_column_);
    if (coloured()) add_columns({"red", "green", "blue"}, colour_column_);
    parsed_.allocate(total_.vertices);
    for_each_row(ex_, index_, 0, index_.rows, [&](const Line& line, std::size_t b) { parse_line(line, blocks_[b]); });
    std::vector<std::vector<Triangle>> parts;
    for (ObjBlock& block : blocks_) parts.push_back(std::move(block.triangles));
    if (colour_column_ > 0 && coloured()) type_colours();
    PointTable table = parsed_.table();
    if (!coloured()) drop_columns(table, colour_column_);
    if (!normals_match()) drop_columns(table, normal_column_);
    return assemble_mesh(ex_, source_, table, concatenate(std::move(parts)), options);
  }

 private:
  /// Relative indices need to know how many vertices come before a line.
  void count() {
    blocks_.resize(index_.blocks.size());
    for_each_row(ex_, index_, 0, index_.rows, [&](const Line& line, std::size_t b) {
      Values values(source_, line);
      const Keyword keyword = keyword_of(values.word());
      if (keyword == Keyword::vertex && blocks_[b].seen.vertices++ == 0) blocks_[b].coloured = has_words(values, 6);
      if (keyword == Keyword::normal) ++blocks_[b].seen.normals;
    });
    for (ObjBlock& block : blocks_) {
      block.before = total_;
      total_.vertices += block.seen.vertices;
      total_.normals += block.seen.normals;
      block.seen = {};
    }
  }

  /// True if `values` goes on with this many words.
  static bool has_words(Values values, int expected) {
    int count = 0;
    while (!values.word().empty()) ++count;
    return count == expected;
  }

  /// True unless a vertex without a colour has been seen.
  [[nodiscard]] bool coloured() const {
    return std::all_of(blocks_.begin(), blocks_.end(), [](const ObjBlock& block) { return block.coloured; });
  }

  /// True unless a corner has named the normal of another vertex.
  [[nodiscard]] bool normals_match() const {
    return std::all_of(blocks_.begin(), blocks_.end(), [](const ObjBlock& block) { return block.normals_match; });
  }

  void add_columns(const std::array<const char*, 3>& names, std::size_t& first) {
    first = parsed_.size();
    for (const char* name : names) parsed_.add(name, AttributeType::float32);
  }

  /// Drops three columns. @param first  0: they were never added
  static void drop_columns(PointTable& table, std::size_t first) {
    if (first == 0) return;
    const auto begin = table.columns.begin() + static_cast<std::ptrdiff_t>(first);
    table.columns.erase(begin, begin + 3);
  }

  /// Colours are bytes if they are shares of 255 or bytes; others, such as those of light, stay floats.
  void type_colours() {
    const std::array<std::size_t, 3> columns{colour_column_, colour_column_ + 1, colour_column_ + 2};
    const auto all = [&](auto holds) {
      return std::all_of(columns.begin(), columns.end(), [&](std::size_t c) { return (parsed_.*holds)(c); });
    };
    const bool shares = all(&ParsedColumns::holds_shares);
    if (!shares && !all(&ParsedColumns::holds_bytes)) return;
    for (const std::size_t c : columns) {
      if (shares) parsed_.to_bytes(c);
      parsed_.redeclare(c, parsed_.name(c), AttributeType::uint8);
    }
  }

  void parse_line(const Line& line, ObjBlock& block) {
    Values values(source_, line);
    switch (keyword_of(values.word())) {
      case Keyword::vertex: {
        const std::int64_t row = block.before.vertices + block.seen.vertices++;
        set_three(values, 0, row);
        if (colour_column_ == 0 || !block.coloured) break;
        block.coloured = has_words(values, 3);
        if (block.coloured) set_three(values, colour_column_, row);
        break;
      }
      case Keyword::normal: {
        const std::int64_t row = block.before.normals + block.seen.normals++;
        if (normal_column_ > 0) set_three(values, normal_column_, row);
        break;
      }
      case Keyword::face:
        parse_face(values, line, block);
        break;
      case Keyword::other:
        break;
    }
  }

  void set_three(Values& values, std::size_t column, std::int64_t row) {
    for (std::size_t axis = 0; axis < 3; ++axis) parsed_.set(column + axis, row, values.number());
  }

  /// Corners are v, v/t, v//n or v/t/n.
  void parse_face(Values& values, const Line& line, ObjBlock& block) {
    std::vector<std::int32_t> corners;
    while (!values.at_end()) {
      const std::string_view word = values.word();
      const std::size_t slash = word.find('/');
      const std::int64_t vertex =
          resolve(word.substr(0, slash), line, block.before.vertices + block.seen.vertices, total_.vertices);
      corners.push_back(static_cast<std::int32_t>(vertex));
      if (slash == std::string_view::npos) continue;
      const std::size_t second = word.find('/', slash + 1);
      if (second == std::string_view::npos) continue;
      const std::int64_t normal =
          resolve(word.substr(second + 1), line, block.before.normals + block.seen.normals, total_.normals);
      block.normals_match = block.normals_match && normal == vertex;
    }
    append_fan(corners, block.triangles);
  }

  /// The id from 0 behind an index that counts from 1, or from -1 downwards from what was `defined` last.
  [[nodiscard]] std::int64_t resolve(std::string_view word, const Line& line, std::int64_t defined,
                                     std::int64_t total) const {
    std::int64_t index = 0;
    const char* end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(word.data(), end, index);
    if (error != std::errc{} || rest != end)
      fail_at_line(source_, "a face has the garbled corner " + in_quotes(word), line.number, "export the file again");
    if (index == 0 || index > total || index < -defined)
      fail_at_line(source_, fmt::format("a face names index {}, but there are {}", index, index < 0 ? defined : total),
                   line.number, "export the file again");
    return index > 0 ? index - 1 : defined + index;
  }

  exec::Cpu& ex_;
  const Source& source_;
  LineIndex index_;
  std::vector<ObjBlock> blocks_;
  Counts total_;
  ParsedColumns parsed_;
  std::size_t normal_column_ = 0, colour_column_ = 0;  ///< 0: there are none
};

}  // namespace

Mesh parse_obj(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  return ObjParser(ex, source).parse(options);
}

}  // namespace pointskin::io
