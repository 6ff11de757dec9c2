#include "option_table.hpp"
#include "scene/vector_json.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

/// A row or a group with an object, for the order of a report.
struct Entry {
  int place;
  std::string name;
  Json json;
};

Json json_of(const OptionRow& row) {
  const Json json = std::visit([](const auto& value) { return Json(value); }, row.binding.value());
  const bool unset = json.is_string() && json.get_ref<const std::string&>().empty();
  return unset ? Json(nullptr) : json;
}

Json type_of(const OptionRow& row) {
  if (!row.binding.words.empty()) return {{"enum", row.binding.words}};
  const Shown value = row.binding.value();
  if (std::holds_alternative<std::vector<std::string>>(value))
    return {{"type", "array"}, {"items", {{"type", "string"}}}};
  if (std::holds_alternative<std::vector<Vec3d>>(value))
    return {{"type", "array"}, {"items", {{"type", "array"}, {"items", {{"type", "number"}}}}}};
  if (std::holds_alternative<std::optional<double>*>(row.binding.target)) return {{"type", {"number", "null"}}};
  if (std::holds_alternative<std::optional<std::int64_t>*>(row.binding.target)) return {{"type", {"integer", "null"}}};
  const Json json = json_of(row);
  if (json.is_null()) return {{"type", {"string", "null"}}};
  return {{"type", json.is_number_integer() ? "integer" : json.type_name()}};
}

Json schema_of(const OptionRow& row) {
  Json schema = type_of(row);
  if (!row.report.schema.empty()) schema.update(Json::parse(row.report.schema));
  return schema;
}

/// @param describe  of a row @param join  of the entries of a group that is an object
template <class Describe, class Join>
std::vector<Entry> entries_of(const OptionTable& table, const Describe& describe, const Join& join) {
  std::vector<Entry> entries;
  for (const OptionGroup& group : table) {
    std::vector<Entry> own;
    for (const OptionRow& row : group.rows)
      if (!row.report.name.empty()) own.push_back({row.report.place, row.report.name, describe(row)});
    const auto by_place = [](const Entry& a, const Entry& b) { return a.place < b.place; };
    std::stable_sort(own.begin(), own.end(), by_place);
    if (!group.object.empty()) own = {{own.front().place, group.object, join(own)}};
    entries.insert(entries.end(), own.begin(), own.end());
    std::stable_sort(entries.begin(), entries.end(), by_place);
  }
  return entries;
}

Json joined(const std::vector<Entry>& entries) {
  Json json = Json::object();
  for (const Entry& entry : entries) json[entry.name] = entry.json;
  return json;
}

/// Objects of their own may be absent.
Json joined_schema(const std::vector<Entry>& entries) {
  Json required = Json::array();
  for (const Entry& entry : entries)
    if (!entry.json.contains("properties")) required.push_back(entry.name);
  return {{"type", "object"}, {"additionalProperties", false}, {"required", required}, {"properties", joined(entries)}};
}

}  // namespace

bool OptionRow::has(const std::string& name) const {
  return fmt::format(",{},", names()).find(fmt::format(",{},", name)) != std::string::npos;
}

OptionRow& OptionGroup::row(const std::string& name) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const OptionRow& row) { return row.has(name); });
  if (found == rows.end()) throw std::logic_error("no option " + name);
  return *found;
}

OptionGroup& OptionGroup::without(std::initializer_list<const char*> names) {
  for (const char* const name : names) row(name).spelling.clear();
  return *this;
}

OptionGroup& OptionGroup::unreported() {
  for (OptionRow& row : rows) row.report = {};
  return *this;
}

nlohmann::ordered_json report_of(const OptionTable& table) { return joined(entries_of(table, json_of, joined)); }

nlohmann::ordered_json schema_of(const OptionTable& table) {
  return joined_schema(entries_of(
      table, [](const OptionRow& row) { return schema_of(row); }, joined_schema));
}

Binding shown_as(Binding binding, std::function<Shown()> value) {
  binding.value = std::move(value);
  return binding;
}

Binding text_for(const std::string& text, std::function<std::string(const std::string&)> settle,
                 std::function<Shown()> value) {
  const auto given = std::make_shared<std::string>(text);
  Binding binding = shown_as(given.get(), std::move(value));
  binding.settle = [given, settle = std::move(settle)] { return settle(*given); };
  return binding;
}

Binding negated(bool& value) {
  return shown_as(turned(value, false), [&value] { return value; });
}

}  // namespace pointskin::cli
