// Legacy VTK files: the points of POLYDATA and UNSTRUCTURED_GRID with their scalars, vectors, normals and field arrays, and
// the triangles of their cells; ascii and binary. Data of cells are passed over.
// Source: "VTK file formats", The VTK User's Guide, section "Simple legacy formats", up to version 5.1.
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "core/format.hpp"
#include "io/number.hpp"
#include "io/pieces.hpp"
#include "io/readers.hpp"
#include "io/vtk.hpp"

namespace pointskin::io {
namespace {

constexpr const char* kExportAgain = "export the file again, as a legacy VTK file";

/// Type of an array's values.
struct VtkType {
  AttributeType type;      ///< that they get
  bool is_bit = false;     ///< eight to a byte, the highest bit first, where the file is binary
  bool is_colour = false;  ///< bytes; shares of 255 where the file is text

  /// Bytes of so many values in a binary file.
  [[nodiscard]] std::size_t bytes(std::int64_t values) const {
    const auto count = static_cast<std::size_t>(values);
    return is_bit ? (count + 7) / 8 : count * size_of(type);
  }
};

std::optional<VtkType> type_of(std::string_view name) {
  struct Entry {
    std::string_view name;
    VtkType type;
  };
  using enum AttributeType;
  static constexpr Entry kTypes[] = {
      {"float", {float32}},
      {"double", {float64}},
      {"int", {int32}},
      {"unsigned_int", {uint32}},
      {"short", {int16}},
      {"unsigned_short", {uint16}},
      {"char", {int8}},
      {"signed_char", {int8}},
      {"unsigned_char", {uint8}},
      {"long", {int64}},
      {"unsigned_long", {uint64}},
      {"vtkIdType", {int32}},
      {"vtktypeint64", {int64}},
      {"vtktypeuint64", {uint64}},
      {"vtktypeint32", {int32}},
      {"vtktypeuint32", {uint32}},
      {"vtktypeint16", {int16}},
      {"vtktypeuint16", {uint16}},
      {"vtktypeint8", {int8}},
      {"vtktypeuint8", {uint8}},
      {"bit", {uint8, true}},
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

/// Cells of one keyword.
struct VtkCells {
  VtkCell type = VtkCell::polygon;  ///< of all of them; those of a grid have types of their own
  bool of_grid = false;
  std::vector<std::int64_t> ends;  ///< of each cell, in `ids`
  std::vector<std::int64_t> ids;
};

class VtkParser {
 public:
  /// @param with_cells  false: they are passed over
  VtkParser(const Source& source, bool with_cells) : source_(source), text_(source.bytes), with_cells_(with_cells) {}

  PointTable parse() {
    read_head();
    while (skip_blank()) read_block();
    if (!has_points_) fail(source_, "holds no POINTS", "only particles (POLYDATA, UNSTRUCTURED_GRID) can be read");
    PointTable table;
    table.rows = rows_;
    table.columns = std::move(columns_);
    return table;
  }

  /// Triangles of what parse() has passed. @throws Error invalid_input
  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::vector<Triangle> triangles;
    std::vector<std::int32_t> corners;
    for (const VtkCells& cells : cells_) {
      if (cells.of_grid && cell_types_.size() != cells.ends.size())
        fail(source_, fmt::format("has {} cells, and types of {}", cells.ends.size(), cell_types_.size()),
             kExportAgain);
      if (!cells.ends.empty() && cells.ends.back() > static_cast<std::int64_t>(cells.ids.size()))
        fail(source_, "has cells without their points", kExportAgain);
      std::int64_t at = 0;
      for (std::size_t cell = 0; cell < cells.ends.size(); ++cell) {
        corners.clear();
        for (; at < cells.ends[cell]; ++at) corners.push_back(checked_id(cells.ids[static_cast<std::size_t>(at)]));
        append_cell(cells.of_grid ? VtkCell{cell_types_[cell]} : cells.type, corners, triangles);
      }
    }
    return triangles;
  }

 private:
  [[nodiscard]] std::int32_t checked_id(std::int64_t id) const {
    if (id < 0 || id >= rows_)
      fail(source_, fmt::format("has a cell that names point {} of {}", id, rows_), kExportAgain);
    return static_cast<std::int32_t>(id);
  }

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
    if (!is_vtk(line())) fail(source_, "does not begin as a legacy VTK file", kExportAgain);
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
    if (keyword == "CELL_TYPES") return read_cell_types(rest);
    if (keyword == "CELLS" || keyword == "VERTICES" || keyword == "LINES" || keyword == "POLYGONS" ||
        keyword == "TRIANGLE_STRIPS")
      return read_cells(keyword, rest);
    if (keyword == "OFFSETS") return read_offsets(type(rest));
    if (keyword == "CONNECTIVITY") return read_connectivity(type(rest));
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
      return skip_values(count(rest, "colours"), 4, {AttributeType::uint8});
    }
    if (!scalars && !colours && !texture && !tensors && !normals && keyword != "VECTORS")
      fail_here(fmt::format("the keyword {} is unknown", in_quotes(keyword)));
    const std::string name = normals ? "n" : property_name(word(rest));
    if (normals) word(rest);
    std::int64_t components = tensors ? (keyword == "TENSORS" ? 9 : 6) : 3;
    if (colours || texture) components = count(rest, "components");
    const VtkType of = colours ? VtkType{AttributeType::uint8, false, true} : type(rest);
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
    const bool kept = in_point_data_ && tuples == rows_ && components >= 1 && components <= kMostComponents;
    if (!kept) return skip_values(tuples, components, of);
    const bool of_colours = of.is_colour || (of.type == AttributeType::uint8 && vtk_names_colours(name));
    const bool colours = of_colours && (components == 3 || components == 4) && !has_column("red");
    constexpr std::array kColours{"red", "green", "blue", "alpha"};
    std::vector<std::string> names;
    for (std::int64_t c = 0; c < components; ++c) {
      if (colours)
        names.emplace_back(kColours[static_cast<std::size_t>(c)]);
      else if (components == 1)
        names.push_back(name);
      else if (components == 3)
        names.push_back(fmt::format("{}{}{}", name, normals ? "" : "_", "xyz"[c]));
      else
        names.push_back(fmt::format("{}_{}", name, c));
    }
    read_values(names, tuples, of);
  }

  [[nodiscard]] bool has_column(std::string_view name) const {
    return std::any_of(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
  }

  // ---- Cells

  void read_cells(std::string_view keyword, std::string_view& rest) {
    keeps_cells_ = with_cells_ && keyword != "VERTICES" && keyword != "LINES";
    if (keeps_cells_)
      cells_.push_back({keyword == "TRIANGLE_STRIPS" ? VtkCell::strip : VtkCell::polygon, keyword == "CELLS", {}, {}});
    offsets_ = count(rest, "cells");
    connectivity_ = count(rest, "indices");
    const std::size_t before = at_;
    skip_blank();
    if (text_.substr(at_).starts_with("OFFSETS")) return;  // version 5: two arrays follow, cells are one fewer
    at_ = before;
    if (keeps_cells_) return read_counted_cells(cells_.back());
    skip_values(connectivity_, 1, {AttributeType::int32});
  }

  /// Before version 5 every cell is the number of its corners, and these.
  void read_counted_cells(VtkCells& cells) {
    const std::vector<std::int64_t> words = integers(connectivity_, {AttributeType::int32});
    for (std::size_t at = 0; at < words.size();) {
      const std::int64_t corners = words[at++];
      if (corners < 0 || static_cast<std::uint64_t>(corners) > words.size() - at)
        fail_here(fmt::format("a cell promises {} corners", corners));
      cells.ids.insert(cells.ids.end(), words.begin() + static_cast<std::ptrdiff_t>(at),
                       words.begin() + static_cast<std::ptrdiff_t>(at) + corners);
      cells.ends.push_back(static_cast<std::int64_t>(cells.ids.size()));
      at += static_cast<std::size_t>(corners);
    }
    if (static_cast<std::int64_t>(cells.ends.size()) != offsets_)
      fail_here(fmt::format("{} cells are promised, and there are {}", offsets_, cells.ends.size()));
  }

  void read_offsets(const VtkType& of) {
    if (!keeps_cells_) return skip_values(offsets_, 1, of);
    std::vector<std::int64_t> ends = integers(offsets_, of);
    if (!ends.empty() && ends[0] != 0) fail_here("the first cell does not begin at the first index");
    if (!ends.empty()) ends.erase(ends.begin());
    for (std::size_t cell = 0; cell < ends.size(); ++cell)
      if (ends[cell] < (cell == 0 ? 0 : ends[cell - 1]) || ends[cell] > connectivity_)
        fail_here(fmt::format("cell {} ends at index {} of {}", cell, ends[cell], connectivity_));
    cells_.back().ends = std::move(ends);
  }

  void read_connectivity(const VtkType& of) {
    if (!keeps_cells_) return skip_values(connectivity_, 1, of);
    cells_.back().ids = integers(connectivity_, of);
  }

  void read_cell_types(std::string_view& rest) {
    const std::int64_t cells = count(rest, "cells");
    if (!with_cells_) return skip_values(cells, 1, {AttributeType::int32});
    cell_types_ = integers(cells, {AttributeType::int32});
  }

  std::vector<std::int64_t> integers(std::int64_t count, const VtkType& of) {
    if (of.is_bit || !is_integer(of.type)) fail_here("the indices of cells are no whole numbers");
    std::vector<std::int64_t> values(static_cast<std::size_t>(check_room(count, 1, of)));
    if (!binary_) {
      for (std::int64_t& v : values) v = value<std::int64_t>();
      return values;
    }
    visit_type(of.type, [&](auto tag) {
      for (std::int64_t& v : values) {
        v = static_cast<std::int64_t>(load<decltype(tag)>(text_.data() + at_, true));
        at_ += sizeof(tag);
      }
    });
    return values;
  }

  void skip_metadata() {
    while (at_ < text_.size() && !line().empty()) {
    }
  }

  // ---- Values

  [[nodiscard]] std::int64_t check_room(std::int64_t tuples, std::int64_t components, const VtkType& of) const {
    constexpr std::int64_t kMost = std::int64_t{1} << 32;
    std::uint64_t left = text_.size() - at_ + (binary_ ? 0 : 1);  // the last number may end with the file
    std::uint64_t each = static_cast<std::uint64_t>(components) * (binary_ ? size_of(of.type) : 2);
    if (binary_ && of.is_bit) left *= 8;
    if (components > kMost || !fits(static_cast<std::uint64_t>(tuples), each, left))
      fail_here(fmt::format("{} values are promised, but the file ends before", tuples));
    return tuples * components;
  }

  void skip_values(std::int64_t tuples, std::int64_t components, const VtkType& of) {
    const std::int64_t values = check_room(tuples, components, of);
    if (binary_) {
      at_ += of.bytes(values);
      return;
    }
    for (std::int64_t i = 0; i < values; ++i) number();
  }

  /// The next number of a text. @returns where it begins
  std::size_t number(double& value) {
    if (!skip_blank()) fail_here("the file ends before the last value");
    const std::size_t begin = at_;
    const char* rest = parse_number(text_.data() + at_, text_.data() + text_.size(), value);
    if (rest == nullptr) {
      const std::string_view token = text_.substr(at_, text_.find_first_of(" \t\r\n", at_) - at_);
      fail_here(fmt::format("{} is not a number", in_quotes(token)));
    }
    at_ = static_cast<std::size_t>(rest - text_.data());
    return begin;
  }
  double number() {
    double value = 0;
    number(value);
    return value;
  }

  /// The next number of a text as T, in which it must fit. Integers of 64 bits keep all their digits.
  template <class T>
  T value() {
    double wide = 0;
    const std::size_t begin = number(wide);
    if constexpr (!std::is_integral_v<T>) {
      return narrowed<T>(wide);
    } else {
      T whole = 0;
      const char* from = text_.data() + begin + (text_[begin] == '+' ? 1 : 0);
      const auto [end, error] = std::from_chars(from, text_.data() + at_, whole);
      if (error == std::errc{} && end == text_.data() + at_) return whole;
      // Beyond 2^53 a whole number that is written otherwise, such as 1e300, is none that is meant.
      constexpr double kExact = 9007199254740992.0;
      if (wide == std::floor(wide) && std::abs(wide) <= kExact && std::in_range<T>(static_cast<std::int64_t>(wide)))
        return static_cast<T>(wide);
      at_ = begin;
      fail_here(fmt::format("a value does not fit into its type, which holds whole numbers in {}..{}",
                            std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max()));
    }
  }

  /// One column for every name, value by value or as they lie in the file.
  void read_values(const std::vector<std::string>& names, std::int64_t tuples, const VtkType& of) {
    const auto components = static_cast<std::int64_t>(names.size());
    const std::int64_t values = check_room(tuples, components, of);
    const bool coordinates = columns_.empty();  // points come first; in text they are double, whatever is promised
    const AttributeType stored = !binary_ && coordinates ? AttributeType::float64 : of.type;
    const char* data = text_.data() + at_;
    if (!binary_ || of.is_bit) {
      AttributeValues& own = values_.emplace_back(stored, static_cast<std::size_t>(values));
      data = binary_ ? unpack_bits(own) : parse(own, of);
    }
    if (binary_) at_ += of.bytes(values);
    const auto bytes = static_cast<std::int64_t>(size_of(stored));
    for (std::size_t c = 0; c < names.size(); ++c)
      columns_.push_back({names[c], coordinates ? stored : of.type, stored, behind(data, c * size_of(stored)),
                          components * bytes, binary_ && !of.is_bit});
  }

  /// @returns where the values are
  const char* parse(AttributeValues& to, const VtkType& of) {
    return visit_type(to.type(), [&](auto tag) {
      using T = decltype(tag);
      const std::span<T> values = to.edit<T>();
      for (T& v : values) v = of.is_colour ? static_cast<T>(std::round(255 * share())) : value<T>();
      return reinterpret_cast<const char*>(values.data());
    });
  }

  /// The next number of a text, cut off at 0 and 1.
  double share() {
    const double v = number();
    return v > 0 ? std::min(v, 1.0) : 0;
  }

  /// @returns where the values are
  const char* unpack_bits(AttributeValues& to) {
    const std::span<std::uint8_t> values = to.edit<std::uint8_t>();
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<unsigned char>(text_[at_ + i / 8]) >> (7 - i % 8) & 1;
    return reinterpret_cast<const char*>(values.data());
  }

  const Source& source_;
  std::string_view text_;
  std::size_t at_ = 0;
  bool with_cells_ = false, keeps_cells_ = false, binary_ = false, has_points_ = false, in_point_data_ = false;
  std::int64_t rows_ = 0, tuples_ = 0, offsets_ = 0, connectivity_ = 0;
  std::vector<Column> columns_;
  std::deque<AttributeValues> values_;  // those of columns that do not lie in the file
  std::vector<VtkCells> cells_;
  std::vector<std::int64_t> cell_types_;

 public:
  /// What the columns of parse() point into is kept here.
  VtkParser(const VtkParser&) = delete;
  VtkParser& operator=(const VtkParser&) = delete;
};

}  // namespace

Cloud parse_vtk_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  VtkParser parser(source, false);
  return assemble(ex, source, parser.parse(), options.shift);
}

Mesh parse_vtk_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  VtkParser parser(source, true);
  const PointTable table = parser.parse();
  check_vertex_count(source, table.rows);
  Pieces pieces(ex, source, options);
  pieces.add(table, parser.triangles());
  return pieces.take_mesh();
}

}  // namespace pointskin::io
