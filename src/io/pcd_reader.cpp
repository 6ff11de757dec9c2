// PCD, the files of the Point Cloud Library, versions 0.5 to 0.7: ascii, binary and binary_compressed.
// Source: "The PCD (Point Cloud Data) file format", pointclouds.org.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "io/libraries.hpp"
#include "io/lines.hpp"
#include "io/lzf.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

constexpr char kAgain[] = "copy or export it again";
constexpr std::uint64_t kMostFields = 4096;       ///< keeps the search for names cheap on garbled files
constexpr std::uint64_t kMostElements = 1 << 16;  ///< of one field
constexpr std::uint64_t kMostKept = 64;           ///< of one field; longer ones are histograms, which are passed over

/// Values of one kind in every point.
struct PcdField {
  std::string name;
  AttributeType type = AttributeType::float32;
  std::uint64_t count = 1;
  std::size_t offset = 0;  ///< bytes before it in a point

  [[nodiscard]] std::size_t bytes() const { return count * size_of(type); }
  [[nodiscard]] bool is_packed_colour() const {
    return (name == "rgb" || name == "rgba") && count == 1 && size_of(type) == 4;
  }
  [[nodiscard]] bool is_kept() const { return name != "_" && count >= 1 && count <= kMostKept; }
};

enum class PcdData { ascii, binary, compressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t rows = 0;
  PcdData data = PcdData::ascii;
  std::size_t body = 0;    ///< where the points begin
  std::int64_t lines = 0;  ///< before them

  [[nodiscard]] std::size_t row_bytes() const { return fields.back().offset + fields.back().bytes(); }
  /// Puts every field behind the one before it.
  void place() {
    std::size_t offset = 0;
    for (PcdField& field : fields) {
      field.offset = offset;
      offset += field.bytes();
    }
  }
};

class HeaderParser {
 public:
  explicit HeaderParser(const Source& source) : source_(source) {}

  PcdHeader parse() {
    while (!done_) parse_line();
    if (names_.empty()) fail_here("the header names no fields");
    make_fields();
    header_.rows = points_ ? *points_ : width_.value_or(0) * height_.value_or(1);
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail_here(const std::string& what) const { fail_at_line(source_, what, header_.lines, kAgain); }

  void parse_line() {
    const std::string_view rest = source_.bytes.substr(header_.body);
    const std::size_t end = rest.find('\n');
    if (rest.empty() || end == std::string_view::npos) fail_here("the header has no line DATA");
    header_.body += end + 1;
    ++header_.lines;
    const std::vector<std::string_view> words = words_of(rest.substr(0, end));
    if (!words.empty() && words[0][0] != '#') take(words[0], {words.begin() + 1, words.end()});
  }

  std::vector<std::string_view> words_of(std::string_view line) const {
    std::vector<std::string_view> words;
    for (auto at = line.begin(); at != line.end();) {
      at = std::find_if_not(at, line.end(), is_blank);
      const auto end = std::find_if(at, line.end(), is_blank);
      if (at != end) words.emplace_back(at, end);
      if (words.size() > kMostFields + 1) fail_here("the header has too many fields");
      at = end;
    }
    return words;
  }

  void take(std::string_view key, const std::vector<std::string_view>& values) {
    if (key == "FIELDS" || key == "COLUMNS")
      names_.assign(values.begin(), values.end());
    else if (key == "SIZE")
      for (const std::string_view value : values) sizes_.push_back(number(value));
    else if (key == "TYPE")
      types_.assign(values.begin(), values.end());
    else if (key == "COUNT")
      for (const std::string_view value : values) counts_.push_back(number(value));
    else if (key == "WIDTH")
      width_ = only(key, values);
    else if (key == "HEIGHT")
      height_ = only(key, values);
    else if (key == "POINTS")
      points_ = only(key, values);
    else if (key == "DATA")
      take_data(values);
    else if (key != "VERSION" && key != "VIEWPOINT")
      fail_here(fmt::format("the line {} is unknown", in_quotes(key)));
  }

  [[nodiscard]] std::uint64_t number(std::string_view word) const {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    constexpr std::uint64_t kMost = std::uint64_t{1} << 31;  // products stay within 64 bits
    if (error != std::errc{} || end != word.data() + word.size() || value >= kMost)
      fail_here(in_quotes(word) + " is no number of the header");
    return value;
  }

  [[nodiscard]] std::uint64_t only(std::string_view key, const std::vector<std::string_view>& values) const {
    if (values.size() != 1) fail_here(fmt::format("{} needs one number", key));
    return number(values[0]);
  }

  void take_data(const std::vector<std::string_view>& values) {
    const std::string_view kind = values.empty() ? std::string_view() : values[0];
    if (kind == "ascii")
      header_.data = PcdData::ascii;
    else if (kind == "binary")
      header_.data = PcdData::binary;
    else if (kind == "binary_compressed")
      header_.data = PcdData::compressed;
    else
      fail_here(fmt::format("the data are {} instead of ascii, binary or binary_compressed", in_quotes(kind)));
    done_ = true;
  }

  void make_fields() {
    const auto fits_names = [&](std::size_t size) { return size == 0 || size == names_.size(); };
    if (!fits_names(sizes_.size()) || !fits_names(types_.size()) || !fits_names(counts_.size()))
      fail_here("SIZE, TYPE and COUNT must have as many words as FIELDS");
    std::unordered_set<std::string> seen;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      PcdField field{names_[i], type(i), counts_.empty() ? 1 : counts_[i]};
      if (field.name != "_" && !seen.insert(field.name).second)
        fail_here("there are two fields " + in_quotes(field.name));
      if (field.count > kMostElements) fail_here(in_quotes(field.name) + " has too many values a point");
      header_.fields.push_back(std::move(field));
    }
    header_.place();
    if (header_.row_bytes() == 0) fail_here("points have no values");
  }

  [[nodiscard]] AttributeType type(std::size_t i) const {
    const std::uint64_t size = sizes_.empty() ? 4 : sizes_[i];
    const std::string_view kind = types_.empty() ? std::string_view("F") : types_[i];
    constexpr std::array<std::pair<std::string_view, AttributeType>, 10> kTypes{{{"I1", AttributeType::int8},
                                                                                 {"U1", AttributeType::uint8},
                                                                                 {"I2", AttributeType::int16},
                                                                                 {"U2", AttributeType::uint16},
                                                                                 {"I4", AttributeType::int32},
                                                                                 {"U4", AttributeType::uint32},
                                                                                 {"I8", AttributeType::int64},
                                                                                 {"U8", AttributeType::uint64},
                                                                                 {"F4", AttributeType::float32},
                                                                                 {"F8", AttributeType::float64}}};
    const std::string name = fmt::format("{}{}", kind, size);
    const auto* const found =
        std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == name; });
    if (found == kTypes.end()) fail_here(fmt::format("the type {} of {} bytes is unknown", in_quotes(kind), size));
    return found->second;
  }

  const Source& source_;
  PcdHeader header_;
  bool done_ = false;
  std::vector<std::string> names_, types_;
  std::vector<std::uint64_t> sizes_, counts_;
  std::optional<std::uint64_t> width_, height_, points_;
};

/// Where the values of the fields are: one point after the other, or one field after the other.
struct PcdBody {
  const char* data = nullptr;
  bool by_field = false;
};

[[noreturn]] void fail_short(const Source& source, const PcdHeader& header) {
  fail_at_byte(source, fmt::format("is truncated, {} points are promised, but the file ends before", header.rows),
               source.bytes.size(), kAgain);
}

void check_room(const Source& source, const PcdHeader& header, std::uint64_t bytes) {
  if (!fits(header.rows, header.row_bytes(), bytes)) fail_short(source, header);
}

std::string unpack(const Source& source, const PcdHeader& header) {
  if constexpr (!kHasLzf) fail(source, "is compressed, and this build was made without liblzf", "save it as binary");
  const std::string_view body = source.bytes.substr(header.body);
  if (body.size() < 8) fail_short(source, header);
  const auto packed = load<std::uint32_t>(body.data(), false);
  const auto bytes = load<std::uint32_t>(body.data() + 4, false);
  check_room(source, header, bytes);
  if (packed > body.size() - 8) fail_short(source, header);
  if (!fits(bytes, 1, std::uint64_t{kMostLzf} * packed)) fail(source, "the compressed points are garbled", kAgain);
  std::string unpacked;
  if constexpr (kHasLzf) unpacked = unpack_lzf(body.substr(8, packed), bytes);
  if (unpacked.size() != bytes) fail(source, "the compressed points are garbled", kAgain);
  return unpacked;
}

/// The value at which the reader stands, as it is stored in a binary file.
void store_value(Values& values, AttributeType type, char* to) {
  visit_type(type, [&](auto tag) {
    using T = decltype(tag);
    T value{};
    if constexpr (std::is_integral_v<T>) {
      const std::int64_t whole = values.whole();
      if (!std::in_range<T>(whole)) values.fail_garbled("does not fit into its type");
      value = static_cast<T>(whole);
    } else {
      value = narrowed<T>(values.number());
    }
    std::memcpy(to, &value, sizeof(T));
  });
}

/// The points of a text as they are in a binary file, but with coordinates in double.
std::string parse_ascii(exec::Cpu& ex, const Source& source, PcdHeader& header) {
  for (PcdField& field : header.fields)
    if (is_coordinate(field.name) && !is_integer(field.type)) field.type = AttributeType::float64;
  header.place();
  const LineIndex index = index_lines(ex, source.bytes.substr(header.body), header.lines + 1);
  if (static_cast<std::uint64_t>(index.rows) < header.rows) fail_short(source, header);
  std::uint64_t elements = 0;
  for (const PcdField& field : header.fields) elements += field.count;
  if (!fits(header.rows, 2 * elements, source.bytes.size() - header.body + 1)) fail_short(source, header);
  const std::size_t row_bytes = header.row_bytes();
  std::string image(header.rows * row_bytes, '\0');
  for_each_row(ex, index, 0, static_cast<std::int64_t>(header.rows), [&](const Line& line, std::size_t) {
    Values values(source, line);
    char* to = image.data() + static_cast<std::size_t>(line.row) * row_bytes;
    for (const PcdField& field : header.fields)
      for (std::uint64_t i = 0; i < field.count; ++i, to += size_of(field.type)) store_value(values, field.type, to);
    values.expect_end();
  });
  return image;
}

/// Columns of the fields; those of packed colours are unpacked into `colours`.
PointTable columns_of(const PcdHeader& header, const PcdBody& body, std::deque<std::vector<std::uint8_t>>& colours) {
  PointTable table{static_cast<std::int64_t>(header.rows), {}};
  for (const PcdField& field : header.fields) {
    if (!field.is_kept()) continue;
    const std::size_t step = body.by_field ? field.bytes() : header.row_bytes();
    const char* const data = behind(body.data, body.by_field ? header.rows * field.offset : field.offset);
    if (field.is_packed_colour()) {
      constexpr std::array kChannels{std::pair{"red", 16}, std::pair{"green", 8}, std::pair{"blue", 0},
                                     std::pair{"alpha", 24}};
      for (std::size_t c = 0; c < field.name.size(); ++c) {
        std::vector<std::uint8_t>& values = colours.emplace_back(header.rows);
        for (std::uint64_t i = 0; i < header.rows; ++i)
          values[i] = static_cast<std::uint8_t>(load<std::uint32_t>(data + i * step, false) >> kChannels[c].second);
        table.columns.push_back({kChannels[c].first, AttributeType::uint8, AttributeType::uint8,
                                 reinterpret_cast<const char*>(values.data()), 1});
      }
      continue;
    }
    for (std::uint64_t i = 0; i < field.count; ++i)
      table.columns.push_back({field.count == 1 ? field.name : fmt::format("{}_{}", field.name, i), field.type,
                               field.type, behind(data, i * size_of(field.type)), static_cast<std::int64_t>(step)});
  }
  return table;
}

}  // namespace

bool is_pcd(std::string_view start) { return start.starts_with("# .PCD") || start.starts_with("VERSION .7"); }

Cloud parse_pcd(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  PcdHeader header = HeaderParser(source).parse();
  std::string own;
  PcdBody body{source.bytes.data() + header.body};
  if (header.data == PcdData::binary) {
    check_room(source, header, source.bytes.size() - header.body);
  } else {
    own = header.data == PcdData::ascii ? parse_ascii(ex, source, header) : unpack(source, header);
    body = {own.data(), header.data == PcdData::compressed};
  }
  std::deque<std::vector<std::uint8_t>> colours;
  return assemble(ex, source, columns_of(header, body, colours), options.shift);
}

}  // namespace pointskin::io
