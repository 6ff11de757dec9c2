#include "json_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>

namespace pointskin::cli {

void JsonReader::fail(const std::string& story) const {
  throw Error(ErrorCode::invalid_input, fmt::format("{}: {}", place_, story));
}

bool JsonReader::has(const std::string& key) const {
  if (!value_->is_object()) fail("must be an object");
  return value_->contains(key);
}

JsonReader JsonReader::at(const std::string& key) const {
  if (!has(key)) fail(fmt::format("lacks \"{}\"", key));
  return {(*value_)[key], fmt::format("{}{}{}", place_, place_.ends_with(": ") ? "" : ".", key)};
}

void JsonReader::allow(const std::vector<std::string>& keys) const {
  if (!value_->is_object()) fail("must be an object");
  for (const auto& [key, value] : value_->items())
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) fail(fmt::format("\"{}\" is not known here", key));
}

std::vector<JsonReader> JsonReader::elements(std::size_t count) const {
  if (!value_->is_array()) fail("must be an array");
  if (count > 0 && value_->size() != count) fail(fmt::format("must have {} elements", count));
  std::vector<JsonReader> elements;
  for (std::size_t i = 0; i < value_->size(); ++i)
    elements.emplace_back((*value_)[i], fmt::format("{}[{}]", place_, i));
  return elements;
}

double JsonReader::number() const {
  if (!value_->is_number()) fail("must be a number");
  const auto number = value_->get<double>();
  if (!std::isfinite(number)) fail("must be finite");
  return number;
}

bool JsonReader::boolean() const {
  if (!value_->is_boolean()) fail("must be true or false");
  return value_->get<bool>();
}

std::string JsonReader::text() const {
  if (!value_->is_string()) fail("must be a text");
  return value_->get<std::string>();
}

std::vector<double> JsonReader::numbers(std::size_t count) const {
  std::vector<double> numbers;
  for (const JsonReader& element : elements(count)) numbers.push_back(element.number());
  return numbers;
}

nlohmann::json read_json(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::invalid_input, fmt::format("{}: cannot be opened", path));
  try {
    return nlohmann::json::parse(file);
  } catch (const nlohmann::json::parse_error& error) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: no valid JSON at byte {}", path, error.byte));
  }
}

}  // namespace pointskin::cli
