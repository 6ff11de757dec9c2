#include "edit_document.hpp"

#include <algorithm>

#include "scene/options.hpp"

namespace pointskin::cli {

std::string option_of(const OptionTable& table, const std::string& key) {
  for (const OptionGroup& group : table)
    for (const OptionRow& row : group.rows)
      if (row.report.name == key && !row.spelling.empty()) return row.names().substr(row.names().rfind(',') + 1);
  return "";
}

void take_options(const scene::Document& document, const OptionTable& table, const GivenOptions& given,
                  Options& options) {
  const std::vector<std::string>& keys = scene::option_keys();
  for (const std::string& key : document.options_given)
    if (std::find(keys.begin(), keys.end(), key) != keys.end() && !given.has(option_of(table, key)))
      scene::copy_option(key, document.options, options);
}

std::vector<std::string> files_of(const scene::Document& document) {
  std::vector<std::string> files;
  for (const scene::CloudSource& cloud : document.base.clouds)
    if (!cloud.file.empty()) files.push_back(cloud.file);
  for (const auto& operation : document.operations) {
    const std::vector<std::string> more = scene::files_of(operation, "/");
    files.insert(files.end(), more.begin(), more.end());
  }
  return files;
}

bool begins_with_normals(const scene::Document& document) {
  return !document.operations.empty() && document.operations.front().at("op") == "orient";
}

}  // namespace pointskin::cli
