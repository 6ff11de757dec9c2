#include "io/numpy_table.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.hpp"
#include "io/scalar.hpp"
#include "io/text_columns.hpp"

namespace pointskin::io {
namespace {

constexpr std::int64_t kMostColumns = 64;  ///< of an array that becomes attributes
constexpr ColumnNames kColourNames{"red", "green", "blue", "alpha"};

template <std::size_t kCount>
bool is_one_of(const std::string& name, const std::array<const char*, kCount>& words) {
  std::string lowered = name;
  for (char& c : lowered) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return std::find(words.begin(), words.end(), lowered) != words.end();
}

/// Calls f(value) for every value of a column.
template <class F>
void for_values(const Column& column, std::int64_t rows, const F& f) {
  visit_type(column.stored, [&](auto tag) {
    for (std::int64_t row = 0; row < rows; ++row)
      f(static_cast<double>(load<decltype(tag)>(column.data + row * column.stride_bytes, column.swapped)));
  });
}

/// True if `is` is true of all values of the columns from `first` on.
template <class F>
bool all_of(const PointTable& table, std::size_t first, const F& is) {
  bool all = true;
  for (std::size_t c = first; c < table.columns.size(); ++c)
    for_values(table.columns[c], table.rows, [&](double v) { all = all && is(v); });
  return all;
}

bool is_share(double v) { return v >= 0 && v <= 1; }
bool is_byte(double v) { return v >= 0 && v <= 255 && v == std::floor(v); }

/// True if three columns hold nothing but whole numbers in 0..255, and some exceed one.
bool are_colours(const NpyArray& array, std::int64_t first) {
  NumpyTable some(array.rows);
  some.add_vector(array, first, 3, kColourNames);
  return all_of(some.table(), 0, is_byte) && !all_of(some.table(), 0, is_share);
}

void add_plain(const Source& source, const NpyArray& array, NumpyTable& to) {
  const std::int64_t columns = array.columns;
  constexpr std::array<std::int64_t, 5> kAgreed{3, 4, 6, 7, 9};
  if (array.is_flat || std::find(kAgreed.begin(), kAgreed.end(), columns) == kAgreed.end())
    fail(source, fmt::format("an array of {} columns has no agreed meaning", columns),
         "save one of shape (n, 3), or several by their names with numpy.savez: points, normals, ...");
  to.add_vector(array, 0, 3, kPositionNames);
  if (columns == 4 || columns == 7) to.add_vector(array, 3, 1, {"scalar"});
  if (columns == 7) to.add_colours(array, 4, 3);
  if (columns == 6 && are_colours(array, 3)) return to.add_colours(array, 3, 3);
  if (columns == 6) return to.add_vector(array, 3, 3, kNormalNames);
  if (columns != 9) return;
  const bool colours_first = are_colours(array, 3) || !are_colours(array, 6);
  to.add_colours(array, colours_first ? 3 : 6, 3);
  to.add_vector(array, colours_first ? 6 : 3, 3, kNormalNames);
}

}  // namespace

bool names_positions(const std::string& name) {
  return is_one_of(name, std::array{"points", "point", "positions", "position", "xyz", "pos", "vertices", "verts",
                                    "coords", "coord", "locations"});
}

bool names_normals(const std::string& name) {
  return is_one_of(name, std::array{"normals", "normal", "nrm", "vertex_normals"});
}

bool names_colours(const std::string& name) {
  return is_one_of(
      name, std::array{"rgb", "rgba", "colors", "colours", "color", "colour", "vertex_colors", "vertex_colours"});
}

bool names_faces(const std::string& name) { return is_one_of(name, std::array{"faces", "triangles", "tris", "f"}); }

Column NumpyTable::column(const NpyArray& array, std::int64_t c, std::string name) const {
  const NpyField& field = array.fields[0];
  return {std::move(name), field.type, field.type, array.column(c), row_bytes_ > 0 ? row_bytes_ : array.stride(),
          field.swapped};
}

void NumpyTable::add_vector(const NpyArray& array, std::int64_t first, std::int64_t count, const ColumnNames& names) {
  for (std::int64_t c = 0; c < count; ++c)
    table_.columns.push_back(column(array, first + c, std::string(names[static_cast<std::size_t>(c)])));
}

void NumpyTable::add_colours(const NpyArray& array, std::int64_t first, std::int64_t count) {
  const std::size_t begin = table_.columns.size();
  add_vector(array, first, count, kColourNames);
  if (array.fields[0].type == AttributeType::uint8) return;
  if (all_of(table_, begin, is_share)) {
    if (!is_integer(array.fields[0].type)) make_bytes(begin, 255);
  } else if (all_of(table_, begin, is_byte)) {
    make_bytes(begin, 1);
  }
}

void NumpyTable::make_bytes(std::size_t first, double factor) {
  for (std::size_t c = first; c < table_.columns.size(); ++c) {
    std::vector<std::uint8_t>& bytes = bytes_.emplace_back();
    bytes.reserve(static_cast<std::size_t>(table_.rows));
    for_values(table_.columns[c], table_.rows,
               [&](double v) { bytes.push_back(static_cast<std::uint8_t>(std::lround(factor * v))); });
    table_.columns[c] = {table_.columns[c].name, AttributeType::uint8, AttributeType::uint8,
                         reinterpret_cast<const char*>(bytes.data()), 1};
  }
}

void NumpyTable::add_attributes(const std::string& name, const NpyArray& array) {
  if (array.columns > kMostColumns) return;
  for (std::int64_t c = 0; c < array.columns; ++c)
    table_.columns.push_back(column(array, c, array.columns == 1 ? name : fmt::format("{}_{}", name, c)));
}

void NumpyTable::add_fields(const NpyArray& array) {
  std::vector<std::string> names;
  for (const NpyField& field : array.fields) names.push_back(field.name);
  names = canonical_names(std::move(names));
  row_bytes_ = array.item_bytes;
  for (std::size_t f = 0; f < names.size(); ++f) {
    const NpyField& field = array.fields[f];
    if (field.is_padding || field.count == 0 || field.count > kMostColumns) continue;
    NpyArray values;
    values.fields = {{field.name, field.type, field.swapped}};
    values.rows = table_.rows;
    values.columns = field.count;
    values.item_bytes = static_cast<std::int64_t>(size_of(field.type));
    values.data = behind(array.data, field.offset);
    if ((field.count == 3 || field.count == 4) && names_colours(field.name))
      add_colours(values, 0, field.count);
    else if (field.count == 3 && (names_positions(field.name) || names_normals(field.name)))
      add_vector(values, 0, 3, names_positions(field.name) ? kPositionNames : kNormalNames);
    else
      add_attributes(names[f], values);
  }
  row_bytes_ = 0;
}

NumpyTable table_of(const Source& source, const NpyArray& array) {
  NumpyTable table(array.is_structured() ? array.rows * array.columns : array.rows);
  if (array.is_structured())
    table.add_fields(array);
  else
    add_plain(source, array, table);
  return table;
}

}  // namespace pointskin::io
