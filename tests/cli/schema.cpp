#include "cli/schema.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;

bool has_type(const Json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  return type == "null" && value.is_null();
}

bool has_any_type(const Json& value, const Json& types) {
  if (types.is_string()) return has_type(value, types.get<std::string>());
  for (const Json& type : types) {
    if (has_type(value, type.get<std::string>())) return true;
  }
  return false;
}

bool is_listed(const Json& value, const Json& list) {
  for (const Json& item : list) {
    if (item == value) return true;
  }
  return false;
}

std::vector<std::string> own_violations(const Json& schema, const Json& value, const std::string& place) {
  std::vector<std::string> found;
  if (schema.contains("type") && !has_any_type(value, schema["type"]))
    found.push_back(place + " is no " + schema["type"].dump());
  if (schema.contains("const") && value != schema["const"])
    found.push_back(place + " is not " + schema["const"].dump());
  if (schema.contains("enum") && !is_listed(value, schema["enum"])) found.push_back(place + " is not in its list");
  if (schema.contains("minimum") && value.is_number() && value < schema["minimum"])
    found.push_back(place + " is too small");
  for (const Json& key : schema.value("required", Json::array())) {
    if (!value.contains(key.get<std::string>())) found.push_back(place + " lacks " + key.get<std::string>());
  }
  return found;
}

}  // namespace

std::vector<std::string> schema_violations(const Json& schema, const Json& value, const std::string& place) {
  std::vector<std::string> found = own_violations(schema, value, place);
  const auto add = [&found](const std::vector<std::string>& more) {
    found.insert(found.end(), more.begin(), more.end());
  };
  const Json properties = schema.value("properties", Json::object());
  for (auto part = value.begin(); value.is_object() && part != value.end(); ++part) {
    if (properties.contains(part.key())) {
      add(schema_violations(properties[part.key()], *part, place + "." + part.key()));
    } else if (schema.contains("additionalProperties")) {
      found.push_back(place + " has the unknown key " + part.key());
    }
  }
  if (value.is_array() && schema.contains("items")) {
    for (const Json& item : value) add(schema_violations(schema["items"], item, place + "[]"));
  }
  return found;
}

}  // namespace pointskin::test
