// Arrays of NumPy as they lie in a file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/attribute.hpp>

#include "io/scalar.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// One member of a structured array; the only one, without a name, of any other.
struct NpyField {
  std::string name;
  AttributeType type = AttributeType::float64;
  bool swapped = false;
  std::int64_t count = 1;   ///< values
  std::int64_t offset = 0;  ///< bytes before it in an item
  bool is_padding = false;

  [[nodiscard]] std::int64_t bytes() const { return count * static_cast<std::int64_t>(size_of(type)); }
};

/// An array of one or two dimensions. Does not own its values.
struct NpyArray {
  std::vector<NpyField> fields;
  std::int64_t rows = 0, columns = 1;
  bool is_flat = true;     ///< of one dimension
  bool by_column = false;  ///< Fortran's order
  std::int64_t item_bytes = 0;
  const char* data = nullptr;

  [[nodiscard]] bool is_structured() const { return !fields.front().name.empty(); }
  /// Where the first value of a column is, and the bytes from row to row.
  [[nodiscard]] const char* column(std::int64_t c) const {
    return behind(data, static_cast<std::size_t>(c * item_bytes * (by_column ? rows : 1)));
  }
  [[nodiscard]] std::int64_t stride() const { return item_bytes * (by_column ? 1 : columns); }
};

/// True if the file starts as .npy does.
bool is_npy(std::string_view start);

/// Reads the header of a .npy file, versions 1 to 3, and checks that all values are there. `source` must outlive it.
/// @throws Error invalid_input, also for arrays of more than two dimensions, of objects, text or complex numbers
NpyArray parse_npy(const Source& source);

/// The header of a .npy file of version 1.
std::string npy_header(AttributeType type, std::int64_t rows, std::int64_t columns);

}  // namespace pointskin::io
