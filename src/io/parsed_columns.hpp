// Columns of points as parsers of text fill them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/attribute.hpp>

#include "io/point_table.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {

/// Columns that a parser fills value by value: double for coordinates, the declared type for everything else.
class ParsedColumns {
 public:
  /// Adds a column; the names x, y and z keep double.
  void add(const std::string& name, AttributeType declared);

  /// Takes the memory: a value of its type a row for every column.
  void allocate(std::int64_t rows);

  /// @param value  whole and within the column's type if that is an integer
  void set(std::size_t column, std::int64_t row, double value) {
    const Storage& to = columns_[column];
    visit_type(to.values.type(), [&](auto tag) {
      using T = decltype(tag);
      static_cast<T*>(to.data)[row] = narrowed<T>(value);
    });
  }

  /// Gives a column another name and type after its values have been seen. They stay stored as they are, and must all
  /// be of that type.
  void redeclare(std::size_t column, const std::string& name, AttributeType declared);

  /// Stores a column in another type from now on; its values are to be set again.
  void store_as(std::size_t column, AttributeType type);

  /// Turns values in [0, 1] into bytes: 255 times as large and rounded. A column of floats.
  void to_bytes(std::size_t column);

  /// True if the column, of floats, holds nothing but whole numbers in 0..255.
  [[nodiscard]] bool holds_bytes(std::size_t column) const;
  /// True if the column, of floats, holds nothing but numbers in [0, 1].
  [[nodiscard]] bool holds_shares(std::size_t column) const;
  /// True if some value of the column, of floats, is larger than `limit`.
  [[nodiscard]] bool exceeds(std::size_t column, float limit) const;

  [[nodiscard]] std::size_t size() const noexcept { return columns_.size(); }
  [[nodiscard]] std::int64_t rows() const noexcept { return rows_; }
  [[nodiscard]] const std::string& name(std::size_t column) const { return columns_[column].name; }
  [[nodiscard]] AttributeType declared(std::size_t column) const { return columns_[column].declared; }

  /// Views of the columns, valid while this lives.
  [[nodiscard]] PointTable table() const;

 private:
  struct Storage {
    std::string name;
    AttributeType declared;
    AttributeValues values;
    void* data = nullptr;
  };

  std::int64_t rows_ = 0;
  std::vector<Storage> columns_;
};

}  // namespace pointskin::io
