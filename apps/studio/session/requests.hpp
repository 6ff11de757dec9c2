// Requests of pages, and what they are answered: JSON, as docs/studio.md lists it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>

#include "scene/json_reader.hpp"
#include "studio/session/application.hpp"

namespace pointskin::studio {

using Json = nlohmann::ordered_json;

struct Request {
  std::shared_ptr<Client> client;
  std::int64_t id = 0;
  std::string what;     ///< "apply" and so on
  nlohmann::json body;  ///< the whole message, an object

  /// The body for strict reading: all other keys than these are refused.
  [[nodiscard]] scene::JsonReader reader(std::initializer_list<std::string_view> keys) const;
};

/// A message as a request. What is none is answered with an error at once.
std::optional<Request> parse_request(const std::shared_ptr<Client>& client, std::string_view text);

/// {"id", "ok": true} with what `result` holds.
void reply(const Request& request, Json result);
/// {"id", "error": {"code", "text"}}. @param code  as name_of(ErrorCode), or "superseded"
void refuse(const Request& request, const std::string& code, const std::string& text);

/// "usage", "invalid_input" and so on.
const char* name_of(ErrorCode code);

}  // namespace pointskin::studio
