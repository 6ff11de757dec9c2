// JSON as the program writes it.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace pointskin::cli {

/// `json` indented, with a line break at the end. Bytes of file names that are no UTF-8 are replaced.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// `text`, its bytes that are no UTF-8 replaced.
inline std::string valid_utf8(const std::string& text) {
  const auto replace = nlohmann::json::error_handler_t::replace;
  return nlohmann::json::parse(nlohmann::json(text).dump(-1, ' ', false, replace)).get<std::string>();
}

}  // namespace pointskin::cli
