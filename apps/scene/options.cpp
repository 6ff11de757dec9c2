#include "scene/options.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>

namespace pointskin::scene {
namespace {

using Json = nlohmann::ordered_json;

struct Row {
  std::string key;
  std::function<Json(const Options&)> get;
  std::function<void(const JsonReader&, Options&)> set;
  std::function<void(const Options&, Options&)> copy;
};

/// A row for a member of one of the structs that Options is made of.
template <class Struct, class T, class Get, class Set>
Row row(const char* key, T Struct::*member, const Get& get, const Set& set) {
  return {key, [=](const Options& options) { return Json(get(options.*member)); },
          [=](const JsonReader& json, Options& options) { options.*member = set(json); },
          [=](const Options& from, Options& to) { to.*member = from.*member; }};
}

template <class Struct>
Row flag(const char* key, bool Struct::*member) {
  return row(
      key, member, [](bool value) { return value; }, [](const JsonReader& json) { return json.boolean(); });
}

template <class Struct>
Row number(const char* key, double Struct::*member) {
  return row(
      key, member, [](double value) { return value; }, [](const JsonReader& json) { return json.number(); });
}

template <class Struct, class T>
Row whole(const char* key, T Struct::*member, std::int64_t lowest, std::int64_t highest) {
  return row(
      key, member, [](T value) { return value; },
      [=](const JsonReader& json) { return static_cast<T>(json.whole_number(lowest, highest)); });
}

/// Two words, of which the second stands for `other`.
template <class Struct, class E>
Row word(const char* key, E Struct::*member, const char* first, E one, std::pair<const char*, E> second) {
  return row(
      key, member, [=](E value) { return value == second.second ? second.first : first; },
      [=](const JsonReader& json) {
        return json.one_of({first, second.first}) == first ? one : second.second;
      });
}

Row open_faces() {
  return row(
      "open", &Options::domain_faces, [](DomainFaces faces) { return faces == DomainFaces::open; },
      [](const JsonReader& json) { return json.boolean() ? DomainFaces::open : DomainFaces::closed; });
}

/// In the order of reports.
std::vector<Row> make_table() {
  constexpr std::int64_t kMostBytes = std::int64_t{1} << 53;  // JSON's numbers are exact so far
  return {whole("depth", &Options::depth, 1, 20),
          word<SolveOptions, FieldKind>("field", &SolveOptions::field, "poisson", FieldKind::poisson,
                                        {"distance", FieldKind::distance}),
          number("screening", &Options::screening),
          whole("iterations", &Options::iterations, 1, 1000),
          number("scale", &Options::scale),
          number("samples_per_node", &Options::samples_per_node),
          flag("confidence", &Options::confidence),
          flag("fixed_screening", &Options::fixed_screening),
          flag("linear_fit", &Options::linear_fit),
          flag("density", &Options::density),
          flag("weakness", &Options::weakness),
          flag("attributes", &Options::attributes),
          flag("normals", &Options::normals),
          open_faces(),
          word<SolveOptions, Boundary>("boundary", &SolveOptions::boundary, "free", Boundary::free,
                                       {"dirichlet", Boundary::dirichlet}),
          number("offset", &Options::offset),
          number("trim", &Options::trim),
          number("island_ratio", &Options::island_ratio),
          flag("largest", &Options::largest),
          number("min_component", &Options::min_component),
          flag("keep_strays", &Options::keep_strays),
          whole("max_memory_bytes", &Options::max_memory_bytes, 0, kMostBytes)};
}

const std::vector<Row>& table() {
  static const std::vector<Row> rows = make_table();
  return rows;
}

const Row* find_row(const std::string& key) {
  const auto found = std::find_if(table().begin(), table().end(), [&](const Row& row) { return row.key == key; });
  return found == table().end() ? nullptr : &*found;
}

}  // namespace

const std::vector<std::string>& option_keys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all;
    for (const Row& row : table()) all.push_back(row.key);
    return all;
  }();
  return keys;
}

nlohmann::ordered_json options_json(const Options& options) {
  Json json = Json::object();
  for (const Row& row : table()) json[row.key] = row.get(options);
  return json;
}

Options read_options(const JsonReader& json, Options options) {
  for (const std::string& key : json.keys()) {
    if (key == "op") continue;
    const Row* const row = find_row(key);
    if (row == nullptr) json.refuse(fmt::format("does not know the key '{}'", key));
    row->set(json.at(key.c_str()), options);
  }
  try {
    validate(options);
    if (options.offset != 0) json.refuse("offset must be 0: a scene has no offset surface");
    if (options.trim < 0) json.refuse("trim must be a number in [0, 1)");
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) throw;
    json.refuse(error.what());
  }
  return options;
}

void copy_option(const std::string& key, const Options& from, Options& to) {
  const Row* const row = find_row(key);
  if (row == nullptr) throw Error(ErrorCode::internal, "no option is called " + key);
  row->copy(from, to);
}

}  // namespace pointskin::scene
