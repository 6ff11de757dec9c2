// Reading JSON that people write: every value is looked up with its place, and whatever is wrong is told with it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pointskin::cli {

/// A value of a JSON file, and where it is: "ops.json: operations[2].stroke". Throws Error invalid_input where it is
/// not what is asked for.
class JsonReader {
 public:
  /// @param value  must outlive the reader
  JsonReader(const nlohmann::json& value, std::string place) : value_(&value), place_(std::move(place)) {}

  [[nodiscard]] const nlohmann::json& value() const { return *value_; }
  [[nodiscard]] const std::string& place() const { return place_; }

  /// A member of an object.
  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] JsonReader at(const std::string& key) const;
  /// Throws unless the object has no members but these.
  void allow(const std::vector<std::string>& keys) const;

  /// The elements of an array, of which there must be `count` unless it is 0.
  [[nodiscard]] std::vector<JsonReader> elements(std::size_t count = 0) const;

  [[nodiscard]] double number() const;  ///< finite
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string text() const;
  /// An array of so many finite numbers.
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;

  /// @throws Error invalid_input with the place
  [[noreturn]] void fail(const std::string& story) const;

 private:
  const nlohmann::json* value_;
  std::string place_;
};

/// The JSON in the file `path`. @throws Error invalid_input if it cannot be read or is no JSON
nlohmann::json read_json(const std::string& path);

}  // namespace pointskin::cli
