#include "io/text_columns.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/format.hpp"
#include "io/lines.hpp"
#include "io/point_table.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

constexpr const char* kNameAdvice = "name the columns in the first line, such as x,y,z,nx,ny,nz";

std::string_view trimmed(std::string_view word) {
  const auto is_frame = [](char c) { return is_blank(c) || c == '"' || c == '\''; };
  while (!word.empty() && is_frame(word.front())) word.remove_prefix(1);
  while (!word.empty() && is_frame(word.back())) word.remove_suffix(1);
  return word;
}

std::string lower(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Splits a line of names. Names may hold blanks where another separator is used.
std::vector<std::string> split_names(std::string_view line) {
  const char* separators = line.find_first_of(",;") != std::string_view::npos ? ",;"
                           : line.find('\t') != std::string_view::npos        ? "\t"
                                                                              : " ";
  std::vector<std::string> names;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(separators), line.size());
    if (const auto name = trimmed(line.substr(0, end)); !name.empty()) names.emplace_back(name);
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return names;
}

bool is_normal(const std::string& name) {
  constexpr std::array<std::string_view, 6> kNormals{"nx", "ny", "nz", "normal_x", "normal_y", "normal_z"};
  return std::find(kNormals.begin(), kNormals.end(), name) != kNormals.end();
}

bool has_name(const std::vector<std::string>& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "1,5 2,5" and "1,5;2,5" would silently become four values.
void check_separators(const Source& source, const Line& line) {
  const std::string_view text = line.text.substr(0, line.text.find('#'));
  std::optional<bool> with_comma;
  bool mixed = text.find(',') != std::string_view::npos && text.find(';') != std::string_view::npos;
  const auto first = std::find_if_not(text.begin(), text.end(), is_separator);
  for (auto at = first; at != text.end();) {
    const auto gap = std::find_if(at, text.end(), is_separator);
    at = std::find_if_not(gap, text.end(), is_separator);
    if (at == text.end()) break;
    const bool comma = std::find(gap, at, ',') != at;
    if (with_comma && *with_comma != comma) mixed = true;
    with_comma = comma;
  }
  if (mixed)
    fail_at_line(source, "commas separate some values but not all", line.number,
                 "write decimal points and one kind of separator");
}

std::vector<std::string> names_in_comment(std::string_view comment) {
  while (!comment.empty() && (comment.front() == '#' || comment.front() == '/' || is_blank(comment.front())))
    comment.remove_prefix(1);
  std::vector<std::string> names = canonical_names(split_names(comment));
  const bool names_points = has_name(names, "x") && has_name(names, "y") && has_name(names, "z");
  return names_points ? names : std::vector<std::string>{};
}

/// True if the line starts with a number: then it is a point, garbled or not, and no line of names.
bool starts_with_number(const Source& source, const Line& line) {
  const std::string_view word = Values(source, line).word();
  double value = 0;
  return parse_number(word.data(), word.data() + word.size(), value) == word.data() + word.size();
}

/// Takes one row of the file's beginning. @returns true if it is the first point
bool take_row(const Source& source, const Line& line, TextLayout& layout) {
  if (layout.names.empty() && !starts_with_number(source, line)) {
    layout.names = canonical_names(split_names(line.text));
    ++layout.header_rows;
    return false;
  }
  Values values(source, line);
  const double first = values.number();
  for (layout.columns = 1; !values.at_end(); ++layout.columns) values.number();
  if (layout.columns == 1 && layout.header_rows == 0) {
    if (!(first >= 0 && first <= 9e15) || first != std::floor(first))
      fail_at_line(source, "a single value is neither a point nor a number of points", line.number, kNameAdvice);
    layout.promised = static_cast<std::int64_t>(first);
    ++layout.header_rows;
    return false;
  }
  check_separators(source, line);
  layout.first_line = line.number;
  return true;
}

}  // namespace

std::vector<std::string> canonical_names(std::vector<std::string> names) {
  std::vector<std::string> lowered;
  lowered.reserve(names.size());
  for (const std::string& name : names) lowered.push_back(lower(name));
  const bool short_colours = has_name(lowered, "r") && has_name(lowered, "g") && has_name(lowered, "b");
  constexpr std::array kKnown{"x",        "y",        "z",   "nx",    "ny",   "nz",   "normal_x",
                              "normal_y", "normal_z", "red", "green", "blue", "alpha"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(kKnown.begin(), kKnown.end(), lowered[i]) != kKnown.end()) names[i] = lowered[i];
    if (!short_colours) continue;
    if (lowered[i] == "r") names[i] = "red";
    if (lowered[i] == "g") names[i] = "green";
    if (lowered[i] == "b") names[i] = "blue";
    if (lowered[i] == "a") names[i] = "alpha";
  }
  return names;
}

TextLayout find_layout(const Source& source) {
  TextLayout layout;
  std::vector<std::string> comment_names;
  Line line;
  bool found = false;
  for_each_line(without_byte_order_mark(source.bytes), [&](std::string_view text) {
    ++line.number;
    line.text = text;
    if (is_row(text))
      found = take_row(source, line, layout);
    else if (text.find_first_of("#/") != std::string_view::npos)
      comment_names = names_in_comment(text);
    return !found;
  });
  if (!found) fail_at_line(source, "holds no points", line.number, "check the program that wrote it");
  if (layout.names.empty() && comment_names.size() == layout.columns) layout.names = comment_names;
  if (!layout.names.empty() && layout.names.size() != layout.columns)
    fail_at_line(source, fmt::format("{} values under {} names", layout.columns, layout.names.size()),
                 layout.first_line, "give every column one name");
  return layout;
}

void check_rows(const Source& source, const TextLayout& layout, std::int64_t rows) {
  if (layout.promised >= 0 && layout.promised != rows)
    fail_at_line(source, fmt::format("the first line promises {} points, but {} follow", layout.promised, rows), 1,
                 "copy the file again or correct its first line");
  // Memory is taken for what the first point has, so the other lines must be able to hold as much. In small files the
  // parser finds the line to blame.
  constexpr std::size_t kSmall = std::size_t{1} << 20;
  if (!fits(static_cast<std::uint64_t>(rows), 2 * layout.columns, std::max(kSmall, source.bytes.size() + 1)))
    fail_at_line(source, fmt::format("most lines have fewer values than the {} of this one", layout.columns),
                 layout.first_line, "export the file again");
}

std::vector<std::string> column_names(const Source& source, const TextLayout& layout) {
  std::vector<std::string> names = layout.names;
  if (names.empty()) {
    constexpr std::array<std::size_t, 5> kAgreed{3, 4, 6, 7, 9};
    if (std::find(kAgreed.begin(), kAgreed.end(), layout.columns) == kAgreed.end())
      fail_at_line(source, fmt::format("lines of {} values have no agreed meaning", layout.columns), layout.first_line,
                   kNameAdvice);
    names = {"x", "y", "z"};
    while (names.size() < layout.columns) names.push_back(std::to_string(names.size()));
  }
  std::vector<std::string> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    fail(source, "has two columns named " + in_quotes(*twice), "give every column its own name");
  for (const char* axis : {"x", "y", "z"})
    if (!has_name(names, axis)) fail(source, fmt::format("has no column named {}", axis), kNameAdvice);
  return names;
}

namespace {

bool is_colour(const std::string& name) {
  return name == "red" || name == "green" || name == "blue" || name == "alpha";
}

/// Where columns without names hold a scalar.
bool holds_scalar(std::size_t columns, std::size_t column) { return column == 3 && (columns == 4 || columns == 7); }

void name_three(std::vector<TextColumn>& columns, std::size_t first, std::array<const char*, 3> names,
                AttributeType type) {
  for (std::size_t i = 0; i < 3; ++i) columns[first + i] = {names[i], type};
}

void name_colours(std::vector<TextColumn>& columns, std::size_t first) {
  name_three(columns, first, {"red", "green", "blue"}, AttributeType::uint8);
}

void name_normals(std::vector<TextColumn>& columns, std::size_t first) {
  name_three(columns, first, {"nx", "ny", "nz"}, AttributeType::float32);
}

void name_by_values(const Source& source, const SeenValues& seen, std::vector<TextColumn>& columns) {
  const auto are_bytes = [&](std::size_t first) {
    return seen.are_bytes(first) && seen.are_bytes(first + 1) && seen.are_bytes(first + 2);
  };
  // Whole numbers up to one could as well be normals along the axes.
  const auto are_surely_colours = [&](std::size_t first) {
    return are_bytes(first) &&
           (seen.are_bytes_over_one(first) || seen.are_bytes_over_one(first + 1) || seen.are_bytes_over_one(first + 2));
  };
  const std::size_t count = columns.size();
  for (std::size_t c = 0; c < count; ++c)
    if (holds_scalar(count, c)) columns[c].name = "scalar";
  if (count == 6 && are_surely_colours(3))
    name_colours(columns, 3);
  else if (count == 6)
    name_normals(columns, 3);
  if (count == 7) {
    if (!are_bytes(4)) fail(source, "the columns 5 to 7 are no colours in 0..255", kNameAdvice);
    name_colours(columns, 4);
  }
  if (count == 9) {
    const bool colours_last = !are_bytes(3) && are_bytes(6);
    if (!colours_last && !are_bytes(3))
      fail(source, "neither the columns 4 to 6 nor 7 to 9 are colours in 0..255", kNameAdvice);
    name_colours(columns, colours_last ? 6 : 3);
    name_normals(columns, colours_last ? 3 : 6);
  }
}

}  // namespace

std::vector<TextColumn> describe_columns(const Source& source, const TextLayout& layout, const SeenValues& seen) {
  std::vector<TextColumn> columns;
  for (std::string& name : column_names(source, layout)) {
    const AttributeType type = is_coordinate(name) ? AttributeType::float64 : AttributeType::float32;
    columns.push_back({std::move(name), type});
  }
  if (layout.names.empty()) name_by_values(source, seen, columns);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!layout.names.empty() && is_colour(columns[c].name) && seen.are_bytes(c))
      columns[c].type = AttributeType::uint8;
    else if (seen.may_be_scalar(c))
      columns[c].type = seen.scalar_type(c);
  }
  return columns;
}

namespace {

/// True if the shortest decimal of the float next to `value` is another number.
bool loses_digits_as_float(double value) {
  const float narrow = to_float(value);
  std::array<char, 32> text;
  const char* end = std::to_chars(text.data(), text.data() + text.size(), narrow).ptr;
  double read = 0;
  std::from_chars(text.data(), end, read);
  return read != value;
}

}  // namespace

SeenValues::SeenValues(const TextLayout& layout) : columns_(layout.columns) {
  for (std::size_t c = 0; c < layout.columns; ++c) {
    Column& column = columns_[c];
    if (layout.names.empty()) {
      column.may_be_scalar = holds_scalar(layout.columns, c);
      column.may_be_colour = c >= 3 && layout.columns >= 6 && !column.may_be_scalar;
      continue;
    }
    const std::string& name = layout.names[c];
    column.may_be_scalar = !is_coordinate(name) && !is_normal(name);
    column.may_be_colour = is_colour(name);
    column.may_be_label = sounds_like_label(name);
  }
}

namespace {

bool is_set(const std::atomic<bool>& flag) { return flag.load(std::memory_order_relaxed); }
void set(std::atomic<bool>& flag) { flag.store(true, std::memory_order_relaxed); }

}  // namespace

void SeenValues::look_for_bytes(Column& column, double value) {
  if (is_set(column.no_bytes)) return;
  const float v = to_float(value);
  if (!(v >= 0 && v <= 255) || v != std::floor(v))
    set(column.no_bytes);
  else if (v > 1 && !is_set(column.over_one))
    set(column.over_one);
}

void SeenValues::look_for_digits(Column& column, double value) {
  if (column.may_be_label && !is_set(column.no_int32)) {
    constexpr double kLowest = std::numeric_limits<std::int32_t>::min();
    constexpr double kHighest = std::numeric_limits<std::int32_t>::max();
    if (!(value >= kLowest && value <= kHighest) || value != std::floor(value)) set(column.no_int32);
  }
  if (is_set(column.loses_digits) || std::isnan(value) || static_cast<double>(to_float(value)) == value) return;
  if (!is_set(column.inexact)) set(column.inexact);
  if (loses_digits_as_float(value)) set(column.loses_digits);
}

bool SeenValues::are_bytes(std::size_t column) const {
  return columns_[column].may_be_colour && !columns_[column].no_bytes;
}

bool SeenValues::are_bytes_over_one(std::size_t column) const { return are_bytes(column) && columns_[column].over_one; }

AttributeType SeenValues::scalar_type(std::size_t column) const {
  const Column& c = columns_[column];
  if (c.may_be_label && !c.no_int32) return AttributeType::int32;
  return c.loses_digits ? AttributeType::float64 : AttributeType::float32;
}

bool SeenValues::exceed_float(std::size_t column) const {
  const AttributeType type = scalar_type(column);
  return type == AttributeType::float64 || (type == AttributeType::int32 && columns_[column].inexact);
}

}  // namespace pointskin::io
