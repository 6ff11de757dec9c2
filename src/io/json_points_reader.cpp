// Particles as JSON: a list of lists of three numbers, [[x, y, z], ...], as splashsurf reads and writes them.
#include "core/format.hpp"
#include "io/lines.hpp"
#include "io/number.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

constexpr const char* kAdvice = "particles in JSON are a list of [x, y, z]";

class JsonPoints {
 public:
  explicit JsonPoints(const Source& source) : source_(source), text_(source.bytes) {}

  std::vector<double> parse() {
    std::vector<double> coordinates;
    expect('[');
    if (next() != ']') {
      do {
        expect('[');
        for (int axis = 0; axis < 3; ++axis) {
          if (axis > 0) expect(',');
          coordinates.push_back(number());
        }
        expect(']');
      } while (accept(','));
    }
    expect(']');
    if (next() != '\0' || at_ < text_.size()) fail_at_byte(source_, "goes on after the last point", at_, kAdvice);
    return coordinates;
  }

 private:
  /// The next character that is no space; 0 at the end.
  char next() {
    while (at_ < text_.size() && (is_blank(text_[at_]) || text_[at_] == '\n')) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool accept(char c) {
    if (next() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail_at_byte(source_, fmt::format("lacks a {}", in_quotes({&c, 1})), at_, kAdvice);
  }
  double number() {
    next();
    double value = 0;
    const char* end = parse_number(text_.data() + at_, text_.data() + text_.size(), value);
    if (end == nullptr) fail_at_byte(source_, "lacks a number", at_, kAdvice);
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }

  const Source& source_;
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

bool looks_like_json(std::string_view bytes, bool want_mesh) {
  const std::string_view text = without_byte_order_mark(bytes);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return !want_mesh && first != std::string_view::npos && text[first] == '[';
}

Cloud parse_json_points(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const std::vector<double> coordinates = JsonPoints(source).parse();
  PointTable table;
  table.rows = static_cast<std::int64_t>(coordinates.size()) / 3;
  const auto* data = reinterpret_cast<const char*>(coordinates.data());
  for (std::size_t axis = 0; axis < 3; ++axis)
    table.columns.push_back({std::string(1, "xyz"[axis]), AttributeType::float64, AttributeType::float64,
                             behind(data, axis * sizeof(double)), 3 * sizeof(double), false});
  return assemble(ex, source, table, options.shift);
}

}  // namespace pointskin::io
