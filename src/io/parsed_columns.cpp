#include "io/parsed_columns.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::io {

void ParsedColumns::add(const std::string& name, AttributeType declared) {
  columns_.push_back({name, declared, AttributeValues(is_coordinate(name) ? AttributeType::float64 : declared)});
}

void ParsedColumns::allocate(std::int64_t rows) {
  rows_ = rows;
  for (std::size_t c = 0; c < columns_.size(); ++c) store_as(c, columns_[c].values.type());
}

void ParsedColumns::store_as(std::size_t column, AttributeType type) {
  Storage& to = columns_[column];
  to.values = AttributeValues();  // frees what was there before the new memory is taken
  to.values = AttributeValues(type, static_cast<std::size_t>(rows_));
  visit_type(type, [&](auto tag) { to.data = to.values.edit<decltype(tag)>().data(); });
}

void ParsedColumns::redeclare(std::size_t column, const std::string& name, AttributeType declared) {
  columns_[column].name = name;
  columns_[column].declared = declared;
}

void ParsedColumns::to_bytes(std::size_t column) {
  for (float& v : columns_[column].values.edit<float>()) v = std::round(255 * v);
}

bool ParsedColumns::holds_bytes(std::size_t column) const {
  const std::vector<float>& values = columns_[column].values.as<float>();
  return std::all_of(values.begin(), values.end(),
                     [](float v) { return v >= 0 && v <= 255 && v == static_cast<float>(static_cast<int>(v)); });
}

bool ParsedColumns::holds_shares(std::size_t column) const {
  const std::vector<float>& values = columns_[column].values.as<float>();
  return std::all_of(values.begin(), values.end(), [](float v) { return v >= 0 && v <= 1; });
}

bool ParsedColumns::exceeds(std::size_t column, float limit) const {
  const std::vector<float>& values = columns_[column].values.as<float>();
  return std::any_of(values.begin(), values.end(), [&](float v) { return v > limit; });
}

PointTable ParsedColumns::table() const {
  PointTable table{rows_, {}};
  for (const Storage& c : columns_) {
    const AttributeType stored = c.values.type();
    table.columns.push_back({c.name, c.declared, stored, static_cast<const char*>(c.data),
                             static_cast<std::int64_t>(size_of(stored)), false});
  }
  return table;
}

}  // namespace pointskin::io
