#include "scene/json_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <istream>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "scene/text.hpp"

namespace pointskin::scene {

void JsonReader::refuse(const std::string& what) const {
  throw Error(ErrorCode::invalid_input, one_line(fmt::format("{}: {}", place_, what)));
}

void JsonReader::object(std::initializer_list<std::string_view> keys) const {
  if (!value_->is_object()) refuse("must be an object { }");
  for (const auto& [key, unused] : value_->items())
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) refuse(fmt::format("does not know the key '{}'", key));
}

JsonReader JsonReader::at(const char* key) const {
  if (!value_->contains(key)) refuse(fmt::format("needs the key '{}'", key));
  return {value_->at(key), fmt::format("{}.{}", place_, key)};
}

std::vector<std::string> JsonReader::keys() const {
  if (!value_->is_object()) refuse("must be an object { }");
  std::vector<std::string> keys;
  for (const auto& [key, unused] : value_->items()) keys.push_back(key);
  return keys;
}

void JsonReader::array() const {
  if (!value_->is_array()) refuse("must be a list [ ]");
}
void JsonReader::array(std::size_t count) const {
  if (!value_->is_array() || value_->size() != count) refuse(fmt::format("must be a list of {}", count));
}

JsonReader JsonReader::at(std::size_t i) const { return {value_->at(i), fmt::format("{}[{}]", place_, i)}; }

double JsonReader::number() const {
  if (!value_->is_number() || !std::isfinite(value_->get<double>())) refuse("must be a number");
  return value_->get<double>();
}

std::int64_t JsonReader::whole_number(std::int64_t lowest, std::int64_t highest) const {
  const bool whole =
      value_->is_number_integer() && (!value_->is_number_unsigned() || value_->get<std::uint64_t>() >> 63 == 0);
  if (!whole || value_->get<std::int64_t>() < lowest || value_->get<std::int64_t>() > highest)
    refuse(fmt::format("must be a whole number in {}..{}", lowest, highest));
  return value_->get<std::int64_t>();
}

bool JsonReader::boolean() const {
  if (!value_->is_boolean()) refuse("must be true or false");
  return value_->get<bool>();
}

std::string JsonReader::text() const {
  if (!value_->is_string()) refuse("must be a text");
  return value_->get<std::string>();
}

std::string JsonReader::one_of(std::initializer_list<std::string_view> words) const {
  if (value_->is_string())
    for (const std::string_view word : words)
      if (value_->get<std::string>() == word) return std::string(word);
  refuse(fmt::format("must be one of {}", fmt::join(words, ", ")));
}

std::vector<double> JsonReader::numbers(std::size_t count) const {
  array(count);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(at(i).number());
  return numbers;
}

Vec3d JsonReader::vector() const {
  array(3);
  return {at(std::size_t{0}).number(), at(1).number(), at(2).number()};
}

std::string read_text(const std::string& path) {
  constexpr std::size_t kPiece = std::size_t{1} << 16;
  std::ifstream file;
  if (path != "-") file.open(path, std::ios::binary);
  std::istream& in = path == "-" ? std::cin : file;
  std::string text;
  std::vector<char> piece(kPiece);  // read() says what failed by the state of the stream; iterators throw
  while (in.read(piece.data(), static_cast<std::streamsize>(kPiece)) || in.gcount() > 0)
    text.append(piece.data(), static_cast<std::size_t>(in.gcount()));
  if ((path != "-" && !file.is_open()) || in.bad())
    throw Error(ErrorCode::invalid_input, fmt::format("{}: cannot be read; is the name right?", path));
  return text;
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::json parse_json(const std::string& text, const std::string& name) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: is not JSON: byte {}", name, error.byte));
  } catch (const nlohmann::json::out_of_range&) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: holds a number that is too large", name));
  }
}

}  // namespace pointskin::scene
