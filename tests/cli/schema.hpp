// The part of JSON Schema that docs/report.schema.json uses.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pointskin::test {

/// Every place where `value` breaks `schema`, as sentences; empty if none. Knows type, const, enum, minimum, required,
/// properties, additionalProperties = false and items.
std::vector<std::string> schema_violations(const nlohmann::json& schema, const nlohmann::json& value,
                                           const std::string& place = "report");

}  // namespace pointskin::test
