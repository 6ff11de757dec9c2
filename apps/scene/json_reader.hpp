// Reading JSON that people write: whatever is wrong is told with its place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/vector.hpp>

namespace pointskin::scene {

/// A value of a JSON file, and where it is: "ops.json.operations[2].stroke". All functions throw Error invalid_input,
/// in one line with the place, where the value is not what is asked for.
class JsonReader {
 public:
  /// @param value  must outlive the reader
  JsonReader(const nlohmann::json& value, std::string place) : value_(&value), place_(std::move(place)) {}

  [[noreturn]] void refuse(const std::string& what) const;

  [[nodiscard]] bool is_array() const { return value_->is_array(); }
  [[nodiscard]] std::size_t size() const { return value_->size(); }

  /// Complains unless this is an object with some of these keys alone.
  void object(std::initializer_list<std::string_view> keys) const;
  [[nodiscard]] bool has(const char* key) const { return value_->contains(key); }
  [[nodiscard]] JsonReader at(const char* key) const;
  /// Those of an object.
  [[nodiscard]] std::vector<std::string> keys() const;

  [[nodiscard]] const nlohmann::json& value() const { return *value_; }
  [[nodiscard]] const std::string& place() const { return place_; }

  /// Complains unless this is an array, or one of `count` elements.
  void array() const;
  void array(std::size_t count) const;
  [[nodiscard]] JsonReader at(std::size_t i) const;

  [[nodiscard]] double number() const;  ///< finite
  [[nodiscard]] std::int64_t whole_number(std::int64_t lowest, std::int64_t highest) const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::string one_of(std::initializer_list<std::string_view> words) const;
  /// An array of so many finite numbers.
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;
  [[nodiscard]] Vec3d vector() const;

 private:
  const nlohmann::json* value_;
  std::string place_;
};

/// The bytes of the file `path`; "-" is stdin. @throws Error invalid_input if it cannot be read
std::string read_text(const std::string& path);

/// `json` as text; bytes of file names that are no UTF-8 are replaced. @param indent  -1: in one line
std::string json_text(const nlohmann::ordered_json& json, int indent);

/// `text` as JSON. @param name  of the file, for errors @throws Error invalid_input, with the byte, if it is none
nlohmann::json parse_json(const std::string& text, const std::string& name);

}  // namespace pointskin::scene
