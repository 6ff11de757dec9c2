// Wavefront OBJ: vertices, vertex normals and polygons; everything else is passed over.
#include <fmt/format.h>

#include <charconv>

#include "io/lines.hpp"
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
    for (const char* axis : {"x", "y", "z"}) parsed_.add(axis, Scalar::float64);
    if (total_.normals == total_.vertices)
      for (const char* axis : {"nx", "ny", "nz"}) parsed_.add(axis, Scalar::float32);
    parsed_.allocate(total_.vertices);
    for_each_row(ex_, index_, 0, index_.rows, [&](const Line& line, std::size_t b) { parse_line(line, blocks_[b]); });
    std::vector<std::vector<Triangle>> parts;
    bool normals_match = true;
    for (ObjBlock& block : blocks_) {
      parts.push_back(std::move(block.triangles));
      normals_match = normals_match && block.normals_match;
    }
    PointTable table = parsed_.table();
    if (!normals_match) table.columns.resize(3);
    return assemble_mesh(ex_, source_, table, concatenate(std::move(parts)), options);
  }

 private:
  /// Relative indices need to know how many vertices come before a line.
  void count() {
    blocks_.resize(index_.blocks.size());
    for_each_row(ex_, index_, 0, index_.rows, [&](const Line& line, std::size_t b) {
      const Keyword keyword = keyword_of(Values(source_, line).word());
      if (keyword == Keyword::vertex) ++blocks_[b].seen.vertices;
      if (keyword == Keyword::normal) ++blocks_[b].seen.normals;
    });
    for (ObjBlock& block : blocks_) {
      block.before = total_;
      total_.vertices += block.seen.vertices;
      total_.normals += block.seen.normals;
      block.seen = {};
    }
  }

  void parse_line(const Line& line, ObjBlock& block) {
    Values values(source_, line);
    switch (keyword_of(values.word())) {
      case Keyword::vertex:
        set_three(values, 0, block.before.vertices + block.seen.vertices++);
        break;
      case Keyword::normal: {
        const std::int64_t row = block.before.normals + block.seen.normals++;
        if (parsed_.size() == 6) set_three(values, 3, row);
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
};

}  // namespace

Mesh parse_obj(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  return ObjParser(ex, source).parse(options);
}

}  // namespace pointskin::io
