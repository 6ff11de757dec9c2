#include <algorithm>
#include <array>
#include <charconv>

#include "io/blocks.hpp"
#include "io/writers.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kBlockRows = 1 << 14;

/// A line that is put together without allocating.
class LineBuffer {
 public:
  void add(std::string_view text) { at_ = std::copy(text.begin(), text.end(), at_); }
  template <class Number>
  void add_number(Number value) {
    at_ = std::to_chars(at_, text_.data() + text_.size(), value).ptr;
  }
  /// Appends the line and an end of line to `out` and starts anew.
  void flush_to(std::string& out) {
    *at_++ = '\n';
    out.append(text_.data(), at_);
    at_ = text_.data();
  }

 private:
  std::array<char, 256> text_;  // three numbers of at most 24 characters, or six ids of at most 11, and little else
  char* at_ = text_.data();
};

template <class Number>
void add_three(LineBuffer& line, std::string_view keyword, Number x, Number y, Number z) {
  line.add(keyword);
  for (const Number value : {x, y, z}) {
    line.add(" ");
    line.add_number(value);
  }
}

/// Appends one part per block of rows: write(i, line) makes line i.
template <class Write>
void append_parts(exec::Cpu& ex, std::size_t rows, std::vector<std::string>& parts, const Write& write) {
  const std::size_t blocks = (rows + kBlockRows - 1) / kBlockRows;
  const std::size_t before = parts.size();
  parts.resize(before + blocks);
  run_in_order(ex, static_cast<std::int64_t>(blocks), [&](std::int64_t b) {
    const std::size_t first = static_cast<std::size_t>(b) * kBlockRows;
    LineBuffer line;
    std::string text;
    for (std::size_t i = first; i < std::min(rows, first + kBlockRows); ++i) {
      write(i, line);
      line.flush_to(text);
    }
    parts[before + static_cast<std::size_t>(b)] = std::move(text);
  });
}

}  // namespace

std::vector<std::string> format_obj(exec::Cpu& ex, const Mesh& mesh) {
  std::vector<std::string> parts;
  const bool is_world = is_zero(mesh.origin);
  append_parts(ex, mesh.vertices.size(), parts, [&](std::size_t i, LineBuffer& line) {
    const Vec3f& p = mesh.vertices[i];
    if (is_world) return add_three(line, "v", p.x, p.y, p.z);
    const Vec3d w = world(mesh.origin, p);
    add_three(line, "v", w[0], w[1], w[2]);
  });
  append_parts(ex, mesh.normals.size(), parts, [&](std::size_t i, LineBuffer& line) {
    add_three(line, "vn", mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z);
  });
  const bool has_normals = !mesh.normals.empty();
  append_parts(ex, mesh.triangles.size(), parts, [&](std::size_t t, LineBuffer& line) {
    line.add("f");
    for (const std::int32_t corner : mesh.triangles[t]) {
      const std::int64_t id = std::int64_t{corner} + 1;
      line.add(" ");
      line.add_number(id);
      if (!has_normals) continue;
      line.add("//");
      line.add_number(id);
    }
  });
  return parts;
}

}  // namespace pointskin::io
