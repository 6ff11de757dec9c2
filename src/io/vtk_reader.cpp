// Legacy VTK files: the points of POLYDATA and UNSTRUCTURED_GRID with their scalars, vectors, normals and field arrays,
// ascii and binary. Cells and their data are passed over.
// Source: "VTK file formats", The VTK User's Guide, section "Simple legacy formats", up to version 5.1.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <deque>
#include <limits>
#include <optional>

#include "io/number.hpp"
#include "io/readers.hpp"

namespace pointskin::io {
namespace {

constexpr const char* kExportAgain = "export the file again, as a legacy VTK file";

/// Type of an array's values: how many bytes, and how to read them.
struct VtkType {
  std::size_t bytes;
  std::optional<Scalar> scalar;  ///< none: a 64-bit integer, or bits
  bool is_signed = true;
};

std::optional<VtkType> type_of(std::string_view name) {
  struct Entry {
    std::string_view name;
    VtkType type;
  };
  static constexpr Entry kTypes[] = {
      {"float", {4, Scalar::float32}},       {"double", {8, Scalar::float64}},
      {"int", {4, Scalar::int32}},           {"unsigned_int", {4, Scalar::uint32}},
      {"short", {2, Scalar::int16}},         {"unsigned_short", {2, Scalar::uint16}},
      {"char", {1, Scalar::int8}},           {"signed_char", {1, Scalar::int8}},
      {"unsigned_char", {1, Scalar::uint8}}, {"long", {8, {}, true}},
      {"unsigned_long", {8, {}, false}},     {"vtkIdType", {4, Scalar::int32}},
      {"vtktypeint64", {8, {}, true}},       {"vtktypeuint64", {8, {}, false}},
      {"vtktypeint32", {4, Scalar::int32}},  {"vtktypeuint32", {4, Scalar::uint32}},
      {"vtktypeint8", {1, Scalar::int8}},    {"vtktypeuint8", {1, Scalar::uint8}},
      {"vtktypeint16", {2, Scalar::int16}},  {"vtktypeuint16", {2, Scalar::uint16}},
  };
  for (const Entry& entry : kTypes)
    if (entry.name == name) return entry.type;
  return std::nullopt;
}

/// The name of a property that other formats can hold, too.
std::string property_name(std::string_view name) {
  std::string out(name);
  for (char& c : out)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-') c = '_';
  return out;
}

class VtkParser {
 public:
  explicit VtkParser(const Source& source) : source_(source), text_(source.bytes) {}

  PointTable parse() {
    read_head();
    while (skip_blank()) read_block();
    if (!has_points_) fail(source_, "holds no POINTS", "only particles (POLYDATA, UNSTRUCTURED_GRID) can be read");
    PointTable table;
    table.rows = rows_;
    table.columns = std::move(columns_);
    return table;
  }

 private:
  // ---- Text

  [[noreturn]] void fail_here(const std::string& what) const { fail_at_byte(source_, what, at_, kExportAgain); }

  /// The rest of the line; the next one begins behind it.
  std::string_view line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view result = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    if (!result.empty() && result.back() == '\r') result.remove_suffix(1);
    return result;
  }

  /// @returns false at the end of the file
  bool skip_blank() {
    while (at_ < text_.size() && (is_blank(text_[at_]) || text_[at_] == '\n')) ++at_;
    return at_ < text_.size();
  }

  /// Cuts the next word off a line; empty at its end.
  static std::string_view word(std::string_view& rest) {
    const auto begin = std::find_if_not(rest.begin(), rest.end(), is_blank);
    const auto end = std::find_if(begin, rest.end(), is_blank);
    const std::string_view result(begin, end);
    rest = std::string_view(end, rest.end());
    return result;
  }

  std::int64_t count(std::string_view& rest, const char* of) const {
    const std::string_view token = word(rest);
    std::int64_t value = -1;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error != std::errc{} || end != token.data() + token.size() || value < 0)
      fail_here(fmt::format("the number of {} is {}", of, in_quotes(token)));
    return value;
  }

  VtkType type(std::string_view& rest) const {
    const std::string_view name = word(rest);
    const std::optional<VtkType> found = type_of(name);
    if (!found) fail_here(fmt::format("the type {} is unknown", in_quotes(name)));
    return *found;
  }

  // ---- Structure

  void read_head() {
    if (!line().starts_with("# vtk DataFile")) fail(source_, "does not begin as a legacy VTK file", kExportAgain);
    line();  // the title
    std::string_view encoding = line();
    const std::string_view name = word(encoding);
    if (name != "ASCII" && name != "BINARY")
      fail_here(fmt::format("the third line says {} instead of ASCII or BINARY", in_quotes(name)));
    binary_ = name == "BINARY";
  }

  void read_block() {
    std::string_view rest = line();
    const std::string_view keyword = word(rest);
    if (keyword == "DATASET") return check_dataset(word(rest));
    if (keyword == "POINTS") return read_points(rest);
    if (keyword == "CELL_TYPES") return skip_values(count(rest, "cells"), 1, 4);
    if (keyword == "CELLS" || keyword == "VERTICES" || keyword == "LINES" || keyword == "POLYGONS" ||
        keyword == "TRIANGLE_STRIPS")
      return skip_cells(rest);
    if (keyword == "OFFSETS" || keyword == "CONNECTIVITY")
      return skip_values(keyword == "OFFSETS" ? offsets_ : connectivity_, 1, type(rest).bytes);
    if (keyword == "POINT_DATA") return begin_data(count(rest, "points"), true);
    if (keyword == "CELL_DATA") return begin_data(count(rest, "cells"), false);
    if (keyword == "METADATA") return skip_metadata();
    if (keyword == "FIELD") return read_field(rest);
    read_attribute(keyword, rest);
  }

  void check_dataset(std::string_view name) const {
    if (name != "POLYDATA" && name != "UNSTRUCTURED_GRID")
      fail_here(fmt::format("the data set is {}, not POLYDATA or UNSTRUCTURED_GRID", in_quotes(name)));
  }

  void read_points(std::string_view& rest) {
    if (has_points_) fail_here("there is a second block of POINTS");
    rows_ = count(rest, "points");
    const VtkType of = type(rest);
    has_points_ = true;
    read_values({"x", "y", "z"}, rows_, of);
  }

  void begin_data(std::int64_t tuples, bool of_points) {
    if (of_points && (!has_points_ || tuples != rows_))
      fail_here(fmt::format("there are data of {} points for {}", tuples, has_points_ ? rows_ : 0));
    tuples_ = tuples;
    in_point_data_ = of_points;
  }

  void read_attribute(std::string_view keyword, std::string_view& rest) {
    const bool scalars = keyword == "SCALARS";
    const bool colours = keyword == "COLOR_SCALARS";
    const bool texture = keyword == "TEXTURE_COORDINATES";
    const bool tensors = keyword == "TENSORS" || keyword == "TENSORS6";
    const bool normals = keyword == "NORMALS";
    if (keyword == "LOOKUP_TABLE") {
      word(rest);
      return skip_values(count(rest, "colours"), 4, 1);
    }
    if (!scalars && !colours && !texture && !tensors && !normals && keyword != "VECTORS")
      fail_here(fmt::format("the keyword {} is unknown", in_quotes(keyword)));
    const std::string name = normals ? "n" : property_name(word(rest));
    if (normals) word(rest);
    std::int64_t components = tensors ? (keyword == "TENSORS" ? 9 : 6) : 3;
    if (colours || texture) components = count(rest, "components");
    const VtkType of = colours ? (binary_ ? VtkType{1, Scalar::uint8} : VtkType{4, Scalar::float32}) : type(rest);
    if (scalars) {
      components = rest.find_first_not_of(" \t") == std::string_view::npos ? 1 : count(rest, "components");
      const std::size_t before = at_;
      std::string_view table = line();
      if (word(table) != "LOOKUP_TABLE") at_ = before;  // left out by some writers
    }
    read_array(name, components, tuples_, of, normals);
  }

  void read_field(std::string_view& rest) {
    word(rest);  // its name
    const std::int64_t arrays = count(rest, "arrays");
    for (std::int64_t a = 0; a < arrays; ++a) {
      if (!skip_blank()) fail_here("the file ends in a field");
      std::string_view head = line();
      const std::string name = property_name(word(head));
      if (name == "METADATA") {
        skip_metadata();
        --a;
        continue;
      }
      const std::int64_t components = count(head, "components");
      const std::int64_t tuples = count(head, "tuples");
      read_array(name, components, tuples, type(head), false);
    }
  }

  void read_array(const std::string& name, std::int64_t components, std::int64_t tuples, const VtkType& of,
                  bool normals) {
    constexpr std::int64_t kMostComponents = 64;
    const bool kept = in_point_data_ && tuples == rows_ && components >= 1 && components <= kMostComponents &&
                      (binary_ || of.bytes != 0);
    if (!kept) return skip_values(tuples, components, of.bytes);
    std::vector<std::string> names;
    for (std::int64_t c = 0; c < components; ++c) {
      if (components == 1)
        names.push_back(name);
      else if (components == 3)
        names.push_back(fmt::format("{}{}{}", name, normals ? "" : "_", "xyz"[c]));
      else
        names.push_back(fmt::format("{}_{}", name, c));
    }
    read_values(names, tuples, of);
  }

  void skip_cells(std::string_view& rest) {
    offsets_ = count(rest, "cells");
    connectivity_ = count(rest, "indices");
    const std::size_t before = at_;
    skip_blank();
    if (text_.substr(at_).starts_with("OFFSETS")) return;  // version 5: two arrays follow, cells are one fewer
    at_ = before;
    skip_values(connectivity_, 1, 4);
  }

  void skip_metadata() {
    while (at_ < text_.size() && !line().empty()) {
    }
  }

  // ---- Values

  [[nodiscard]] std::int64_t check_room(std::int64_t tuples, std::int64_t components, std::size_t bytes) const {
    const auto each = static_cast<std::uint64_t>(components) * (binary_ ? bytes : 2);
    const std::uint64_t left = text_.size() - at_ + (binary_ ? 0 : 1);  // the last number may end with the file
    if (components > (std::int64_t{1} << 32) || !fits(static_cast<std::uint64_t>(tuples), each, left))
      fail_here(fmt::format("{} values are promised, but the file ends before", tuples));
    return tuples * components;
  }

  void skip_values(std::int64_t tuples, std::int64_t components, std::size_t bytes) {
    const std::int64_t values = check_room(tuples, components, bytes);
    if (binary_) {
      at_ += static_cast<std::size_t>(values) * bytes;
      return;
    }
    for (std::int64_t i = 0; i < values; ++i) number();
  }

  double number() {
    if (!skip_blank()) fail_here("the file ends before the last value");
    double value = 0;
    const char* begin = text_.data() + at_;
    const char* rest = parse_number(begin, text_.data() + text_.size(), value);
    if (rest == nullptr) {
      const std::string_view token = text_.substr(at_, text_.find_first_of(" \t\r\n", at_) - at_);
      fail_here(fmt::format("{} is not a number", in_quotes(token)));
    }
    at_ = static_cast<std::size_t>(rest - text_.data());
    return value;
  }

  /// One column for every name, value by value or as they lie in the file.
  void read_values(const std::vector<std::string>& names, std::int64_t tuples, const VtkType& of) {
    const auto components = static_cast<std::int64_t>(names.size());
    const std::int64_t values = check_room(tuples, components, of.bytes);
    const Scalar declared = of.scalar.value_or(Scalar::float64);
    if (binary_ && of.scalar) {
      for (std::size_t c = 0; c < names.size(); ++c)
        columns_.push_back({names[c], declared, declared, text_.data() + at_ + c * of.bytes,
                            components * static_cast<std::int64_t>(of.bytes), true});
      at_ += static_cast<std::size_t>(values) * of.bytes;
      return;
    }
    std::vector<double>& own = values_.emplace_back(static_cast<std::size_t>(values));
    for (double& value : own) value = binary_ ? wide_integer(of) : number();
    const auto* data = reinterpret_cast<const char*>(own.data());
    for (std::size_t c = 0; c < names.size(); ++c)
      columns_.push_back({names[c], declared, Scalar::float64, data + c * sizeof(double),
                          components * static_cast<std::int64_t>(sizeof(double)), false});
  }

  double wide_integer(const VtkType& of) {
    const char* from = text_.data() + at_;
    at_ += sizeof(std::uint64_t);
    const auto bits = load<std::uint64_t>(from, true);
    return of.is_signed ? static_cast<double>(static_cast<std::int64_t>(bits)) : static_cast<double>(bits);
  }

  const Source& source_;
  std::string_view text_;
  std::size_t at_ = 0;
  bool binary_ = false, has_points_ = false, in_point_data_ = false;
  std::int64_t rows_ = 0, tuples_ = 0, offsets_ = 0, connectivity_ = 0;
  std::vector<Column> columns_;
  std::deque<std::vector<double>> values_;  // those of columns that do not lie in the file

 public:
  /// What the columns of parse() point into is kept here.
  VtkParser(const VtkParser&) = delete;
  VtkParser& operator=(const VtkParser&) = delete;
};

}  // namespace

Cloud parse_vtk(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  VtkParser parser(source);
  return assemble(ex, source, parser.parse(), options.shift);
}

}  // namespace pointskin::io
