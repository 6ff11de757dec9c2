#include "requests.hpp"

#include <array>
#include <utility>
#include <vector>

namespace pointskin::studio {
namespace {

constexpr std::int64_t kLastId = (std::int64_t{1} << 53) - 1;  // JavaScript's

/// What a request may hold that nobody reads on purpose: it is on the envelope.
constexpr std::array<std::string_view, 2> kEnvelope = {"id", "do"};

/// Texts may hold bytes of file names that are no UTF-8.
std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Whether arrays and objects lie in each other deeper than any message needs. JSON is copied and freed by recursion, so
/// that a deep one would overflow the stack.
bool is_too_deep(std::string_view text) {
  constexpr int kDeepest = 64;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\') ++i;
    if (c == '"') in_string = !in_string;
    if (in_string) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepest) return true;
  }
  return false;
}

void send_error(Client& client, const Json& id, const std::string& code, const std::string& text) {
  client.send(dumped({{"id", id}, {"error", {{"code", code}, {"text", text}}}}));
}

}  // namespace

scene::JsonReader Request::reader(std::initializer_list<std::string_view> keys) const {
  for (const auto& [key, value] : body.items()) {
    bool known = false;
    for (const std::string_view allowed : kEnvelope) known = known || key == allowed;
    for (const std::string_view allowed : keys) known = known || key == allowed;
    if (!known) throw Error(ErrorCode::usage, what + ": has no '" + key + "'");
  }
  return {body, what};
}

std::optional<Request> parse_request(const std::shared_ptr<Client>& client, std::string_view text) {
  nlohmann::json body;
  if (!is_too_deep(text)) body = nlohmann::json::parse(text, nullptr, false);
  if (!body.is_object()) {
    send_error(*client, nullptr, "usage", "a message must be a JSON object, not too deep");
    return std::nullopt;
  }
  const auto id = body.find("id");
  if (id == body.end() || !id->is_number_integer() || *id < 0 || *id > kLastId) {
    send_error(*client, nullptr, "usage", "a request needs an id, a whole number from 0 on");
    return std::nullopt;
  }
  const auto what = body.find("do");
  if (what == body.end() || !what->is_string()) {
    send_error(*client, Json(id->get<std::int64_t>()), "usage", "a request needs a text 'do'");
    return std::nullopt;
  }
  Request request{client, id->get<std::int64_t>(), what->get<std::string>(), {}};
  request.body = std::move(body);
  return request;
}

void reply(const Request& request, Json result) {
  Json message = {{"id", request.id}, {"ok", true}};
  if (result.is_object()) message.update(result);
  request.client->send(dumped(message));
}

void refuse(const Request& request, const std::string& code, const std::string& text) {
  send_error(*request.client, request.id, code, text);
}

const char* name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage:
      return "usage";
    case ErrorCode::invalid_input:
      return "invalid_input";
    case ErrorCode::no_normals:
      return "no_normals";
    case ErrorCode::empty_result:
      return "empty_result";
    case ErrorCode::over_limit:
      return "over_limit";
    case ErrorCode::device_unavailable:
      return "device_unavailable";
    case ErrorCode::output_not_written:
      return "output_not_written";
    case ErrorCode::interrupted:
      return "interrupted";
    case ErrorCode::internal:
      break;
  }
  return "internal";
}

}  // namespace pointskin::studio
