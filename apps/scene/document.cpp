#include "scene/document.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "scene/options.hpp"
#include "scene/sha256.hpp"
#include "scene/source_json.hpp"
#include "scene/text.hpp"

namespace pointskin::scene {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string sha256_at(const JsonReader& json) {
  const std::string digits = json.text();
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (digits.size() != 64 || !std::all_of(digits.begin(), digits.end(), is_digit))
    json.refuse("must be 64 digits 0-9 and a-f");
  return digits;
}

CloudSource cloud_at(const JsonReader& json, const fs::path& folder) {
  json.object({"file", "sha256", "shape", "points"});
  const SolidSource source = read_source(json, folder);
  CloudSource cloud{source.file, "", source.shape, source.points};
  if (json.has("sha256")) {
    if (source.file.empty()) json.refuse("must not have sha256: a shape has no file");
    cloud.sha256 = sha256_at(json.at("sha256"));
  }
  return cloud;
}

/// The options that a document begins with, and "warm_start", which is none of a reconstruction.
void read_document_options(const JsonReader& json, Document& document) {
  nlohmann::json rest = json.value();
  for (const std::string& key : json.keys()) document.options_given.push_back(key);
  if (json.has("warm_start")) {
    document.warm_start = json.at("warm_start").boolean();
    rest.erase("warm_start");
  }
  document.options = read_options(JsonReader(rest, json.place()), {});
}

/// @param as_written  the same, with the keys in their order
void read_operations(const JsonReader& json, const Json& as_written, Document& document) {
  json.array();
  for (std::size_t i = 0; i < json.size(); ++i) {
    const JsonReader entry = json.at(i);
    check_operation(entry.value(), entry.place());
    document.operations.push_back(as_written.at(i));
  }
  document.done = document.operations.size();
}

void read_done(const JsonReader& json, Document& document) {
  const auto count = static_cast<std::int64_t>(document.operations.size());
  document.done = static_cast<std::size_t>(json.whole_number(0, count));
  const auto goes_back = [](const Json& entry) { return is_undo(entry) || is_redo(entry); };
  if (std::any_of(document.operations.begin(), document.operations.end(), goes_back))
    json.refuse("must not be there with operations undo and redo");
}

Json to_json(const CloudSource& cloud, const fs::path& folder) {
  Json json = Json::object();
  write_source({cloud.file, cloud.shape, cloud.points}, folder, json);
  if (!cloud.sha256.empty()) json["sha256"] = cloud.sha256;
  return json;
}

/// Changes the name of the file of an operation, if it has one.
template <class Rename>
void rename_file(Json& operation, const Rename& rename) {
  Json& holder = operation.contains("with") ? operation["with"] : operation;
  if (holder.contains("file")) holder["file"] = rename(holder["file"].get<std::string>());
}

}  // namespace

std::optional<Vec3d> shift_of(const std::string& text) {
  if (text == "auto") return std::nullopt;
  if (text == "none") return Vec3d{0, 0, 0};
  const std::optional<Vec3d> shift = parse_vector(text);
  if (!shift) throw Error(ErrorCode::invalid_input, fmt::format("shift: '{}' is not auto, none or x,y,z", text));
  return shift;
}

Document parse_document(const std::string& text, const std::string& name, const fs::path& folder) {
  const nlohmann::json json = parse_json(text, name);
  const JsonReader reader(json, name);
  reader.object({"version", "clouds", "shift", "options", "operations", "done"});
  (void)reader.at("version").whole_number(kDocumentVersion, kDocumentVersion);
  Document document;
  if (reader.has("clouds")) {
    const JsonReader clouds = reader.at("clouds");
    clouds.array();
    for (std::size_t i = 0; i < clouds.size(); ++i) document.base.clouds.push_back(cloud_at(clouds.at(i), folder));
  }
  if (reader.has("shift")) {
    document.base.shift = reader.at("shift").text();
    const std::string& shift = document.base.shift;
    if (shift != "auto" && shift != "none" && !parse_vector(shift))
      reader.at("shift").refuse("must be auto, none or x,y,z");
  }
  if (reader.has("options")) read_document_options(reader.at("options"), document);
  const JsonReader operations = reader.at("operations");
  read_operations(operations, Json::parse(text).at("operations"), document);
  for (Json& entry : document.operations)
    rename_file(entry,
                [&folder](const std::string& file) { return fs::absolute(folder / file).lexically_normal().string(); });
  if (reader.has("done")) read_done(reader.at("done"), document);
  return document;
}

Document read_document(const std::string& path) {
  return parse_document(read_text(path), path, fs::absolute(path).parent_path());
}

Json to_json(const Document& document, const fs::path& folder) {
  Json json = {{"version", kDocumentVersion}};
  if (!document.base.clouds.empty()) {
    json["clouds"] = Json::array();
    for (const CloudSource& cloud : document.base.clouds) json["clouds"].push_back(to_json(cloud, folder));
    json["shift"] = document.base.shift;
  }
  json["options"] = options_json(document.options);
  json["options"]["warm_start"] = document.warm_start;
  json["operations"] = document.operations;
  for (Json& entry : json["operations"])
    rename_file(entry, [&folder](const std::string& file) { return file_seen_from(file, folder); });
  if (document.done < document.operations.size()) json["done"] = document.done;
  return json;
}

void write_document(const std::string& path, const Document& document) {
  std::string text;
  try {
    text = json_text(to_json(document, fs::absolute(path).parent_path()), 2) + "\n";
  } catch (const fs::filesystem_error& error) {
    throw Error(ErrorCode::output_not_written,
                fmt::format("{}: cannot be written, its folder: {}", path, error.code().message()));
  }
  write_file_atomically(path, text);
}

std::vector<std::string> check_clouds(const Base& base) {
  std::vector<std::string> notices;
  for (const CloudSource& cloud : base.clouds) {
    if (cloud.file.empty()) continue;
    const std::string sum = sha256_of_file(cloud.file);
    if (!cloud.sha256.empty() && cloud.sha256 != sum)
      notices.push_back(fmt::format("{}: has changed since the document was written", cloud.file));
  }
  return notices;
}

void stamp_clouds(Base& base) {
  for (CloudSource& cloud : base.clouds)
    if (!cloud.file.empty()) cloud.sha256 = sha256_of_file(cloud.file);
}

}  // namespace pointskin::scene
