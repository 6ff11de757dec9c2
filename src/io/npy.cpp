// Source: NumPy Enhancement Proposal 1 and numpy.lib.format.
#include "io/npy.hpp"

#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

#include "core/format.hpp"
#include "io/number.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

constexpr char kMagic[] = "\x93NUMPY";
constexpr char kAgain[] = "save it again with numpy.save";
constexpr std::size_t kMostFields = 1024;
constexpr std::int64_t kMostItemBytes = 1 << 20;

/// The dictionary at the beginning, a literal of Python.
class HeaderParser {
 public:
  HeaderParser(const Source& source, std::string_view text) : source_(source), text_(text) {}

  NpyArray parse() {
    expect('{');
    while (!take('}')) {
      const std::string key = text();
      expect(':');
      if (key == "descr")
        read_type();
      else if (key == "fortran_order")
        array_.by_column = boolean();
      else if (key == "shape")
        read_shape();
      else
        fail_here("the header has the key " + in_quotes(key));
      if (!take(',') && peek() != '}') fail_here("the header is garbled");
    }
    if (array_.fields.empty() || !has_shape_) fail_here("the header names no type or no shape");
    return std::move(array_);
  }

 private:
  [[noreturn]] void fail_here(const std::string& what) const { fail(source_, what, kAgain); }

  char peek() {
    while (at_ < text_.size() && (is_blank(text_[at_]) || text_[at_] == '\n')) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail_here("the header is garbled");
  }

  std::string text() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') fail_here("the header is garbled");
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) fail_here("the header is garbled");
    const std::string_view found = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return std::string(found);
  }

  bool boolean() {
    peek();
    for (const std::string_view word : {"True", "False"})
      if (text_.substr(at_).starts_with(word)) {
        at_ += word.size();
        return word == "True";
      }
    fail_here("the header is garbled");
  }

  std::int64_t whole() {
    peek();
    std::int64_t value = -1;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{} || value < 0) fail_here("the header is garbled");
    at_ = static_cast<std::size_t>(end - text_.data());
    take('L');  // as Python 2 wrote it
    return value;
  }

  /// A tuple of numbers.
  std::vector<std::int64_t> shape() {
    std::vector<std::int64_t> sizes;
    if (peek() != '(') return {whole()};
    expect('(');
    while (!take(')')) {
      sizes.push_back(whole());
      if (sizes.size() > 32) fail_here("the array has too many dimensions");
      if (!take(',') && peek() != ')') fail_here("the header is garbled");
    }
    return sizes;
  }

  void read_shape() {
    const std::vector<std::int64_t> sizes = shape();
    has_shape_ = true;
    if (sizes.size() > 2)
      fail(source_, fmt::format("has {} dimensions instead of one or two", sizes.size()), "reshape it to (n, 3)");
    array_.rows = sizes.empty() ? 1 : sizes[0];
    array_.is_flat = sizes.size() < 2;
    array_.columns = sizes.size() < 2 ? 1 : sizes[1];
  }

  void read_type() {
    array_.fields.clear();
    if (take('[')) {
      while (!take(']')) {
        read_field();
        if (!take(',') && peek() != ']') fail_here("the header is garbled");
      }
      if (array_.fields.empty()) fail_here("the array's items have no fields");
    } else {
      const std::string word = text();
      array_.fields.push_back(scalar(word));
      if (array_.fields[0].is_padding) fail_type(word);
    }
    const NpyField& last = array_.fields.back();
    array_.item_bytes = last.offset + last.bytes();
  }

  void read_field() {
    if (array_.fields.size() >= kMostFields) fail_here("the array's items have too many fields");
    expect('(');
    std::string name = text();
    expect(',');
    if (peek() == '[') fail_here("the field " + in_quotes(name) + " has fields of its own");
    NpyField field = scalar(text());
    if (take(',') && peek() != ')')
      for (const std::int64_t size : shape()) {
        if (size > kMostItemBytes || field.count * size > kMostItemBytes) fail_here("an item is too large");
        field.count *= size;
      }
    expect(')');
    if (!array_.fields.empty()) field.offset = array_.fields.back().offset + array_.fields.back().bytes();
    if (field.offset > kMostItemBytes) fail_here("an item is too large");
    if (name.empty()) name = fmt::format("f{}", array_.fields.size());
    field.name = std::move(name);
    array_.fields.push_back(std::move(field));
  }

  /// "<f4" and the like; "|V2" is padding, which is left without a name.
  NpyField scalar(const std::string& word) {
    if (word.size() < 3) fail_type(word);
    NpyField field;
    field.swapped = word[0] == '>';
    if (word[1] == 'V') {
      std::int64_t bytes = 0;
      const auto [end, error] = std::from_chars(word.data() + 2, word.data() + word.size(), bytes);
      if (error != std::errc{} || end != word.data() + word.size() || bytes < 0 || bytes > kMostItemBytes)
        fail_type(word);
      field.type = AttributeType::uint8;
      field.count = bytes;
      field.is_padding = true;
      return field;
    }
    constexpr std::array<std::pair<std::string_view, AttributeType>, 11> kTypes{{{"b1", AttributeType::uint8},
                                                                                 {"i1", AttributeType::int8},
                                                                                 {"u1", AttributeType::uint8},
                                                                                 {"i2", AttributeType::int16},
                                                                                 {"u2", AttributeType::uint16},
                                                                                 {"i4", AttributeType::int32},
                                                                                 {"u4", AttributeType::uint32},
                                                                                 {"i8", AttributeType::int64},
                                                                                 {"u8", AttributeType::uint64},
                                                                                 {"f4", AttributeType::float32},
                                                                                 {"f8", AttributeType::float64}}};
    for (const auto& [name, type] : kTypes)
      if (std::string_view(word).substr(1) == name &&
          std::string_view("<>|=").find(word[0]) != std::string_view::npos) {
        field.type = type;
        return field;
      }
    fail_type(word);
  }

  [[noreturn]] void fail_type(const std::string& word) const {
    fail(source_, "has values of the type " + in_quotes(word), "save it as float32, float64 or integers");
  }

  const Source& source_;
  std::string_view text_;
  std::size_t at_ = 0;
  bool has_shape_ = false;
  NpyArray array_;
};

}  // namespace

bool is_npy(std::string_view start) { return start.starts_with(kMagic); }

NpyArray parse_npy(const Source& source) {
  const std::string_view bytes = source.bytes;
  if (!is_npy(bytes) || bytes.size() < 12) fail(source, "does not begin as a .npy file", kAgain);
  const int version = bytes[6];
  if (version < 1 || version > 3) fail(source, fmt::format("is of the version {} of .npy", version), kAgain);
  const std::size_t begin = version == 1 ? 10 : 12;
  const std::size_t length = version == 1 ? load<std::uint16_t>(bytes.data() + 8, false)
                                          : std::size_t{load<std::uint32_t>(bytes.data() + 8, false)};
  if (length > bytes.size() - begin) fail_at_byte(source, "is truncated in its header", bytes.size(), kAgain);
  NpyArray array = HeaderParser(source, bytes.substr(begin, length)).parse();
  const std::uint64_t left = bytes.size() - begin - length;
  const auto rows = static_cast<std::uint64_t>(array.rows), columns = static_cast<std::uint64_t>(array.columns);
  const auto item = static_cast<std::uint64_t>(array.item_bytes);
  if (columns > 0 &&
      (!fits(columns, item, std::numeric_limits<std::int64_t>::max()) || !fits(rows, columns * item, left)))
    fail_at_byte(
        source,
        fmt::format("is truncated, {} times {} values are promised, but {} bytes are left", rows, columns, left),
        bytes.size(), kAgain);
  array.data = bytes.data() + begin + length;
  return array;
}

std::string npy_header(AttributeType type, std::int64_t rows, std::int64_t columns) {
  const char kind = !is_integer(type) ? 'f' : static_cast<int>(type) % 2 == 1 ? 'u' : 'i';
  const std::string shape = columns == 0 ? fmt::format("({},)", rows) : fmt::format("({}, {})", rows, columns);
  std::string text = fmt::format("{{'descr': '{}{}{}', 'fortran_order': False, 'shape': {}, }}",
                                 size_of(type) == 1 ? '|' : '<', kind, size_of(type), shape);
  constexpr std::size_t kAlignment = 64;  // of the values in the file
  text.resize((10 + text.size() + 1 + kAlignment - 1) / kAlignment * kAlignment - 10 - 1, ' ');
  text += '\n';
  std::string header(kMagic, 6);
  header += std::string("\1\0", 2);
  header += static_cast<char>(text.size() & 255);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

}  // namespace pointskin::io
