// A row of a PLY file in text.
#pragma once

#include <cstddef>
#include <cstdint>

#include "io/lines.hpp"
#include "io/ply_header.hpp"

namespace pointskin::io {

/// The next value of a line, of a property that is no list.
/// @throws Error invalid_input if there is none, or it does not fit into the property
double read_scalar(Values& values, const PlyProperty& property);

/// The next value of a line as a number of items.
/// @throws Error invalid_input if it is none
std::int64_t read_list_length(Values& values);

/// Calls set(column, value) for every property of the element that is no list, and expects the line to end there.
/// @throws Error invalid_input
template <class Set>
void read_scalars(Values& values, const PlyElement& element, const Set& set) {
  std::size_t column = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.is_list)
      for (std::int64_t i = read_list_length(values); i > 0; --i) values.number();
    else
      set(column++, read_scalar(values, property));
  }
  values.expect_end();
}

/// Lines of an element: one a row, none if its rows hold nothing.
inline std::int64_t lines_of(const PlyElement& element) { return element.properties.empty() ? 0 : element.count; }

/// @throws Error invalid_input if fewer lines are left than the element promises
/// @param lines  that are left
void check_lines(const Source& source, const PlyElement& element, std::int64_t lines);

}  // namespace pointskin::io
