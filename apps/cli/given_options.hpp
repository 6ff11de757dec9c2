// Which options a command line names.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace pointskin::cli {

/// The options that were given, whatever their values. Arguments of a command that have a member `given` of this type
/// get it filled in (finish_command).
class GivenOptions {
 public:
  GivenOptions() = default;
  explicit GivenOptions(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options())
      if (option->count() > 0)
        for (const std::string& name : option->get_lnames()) names_.push_back("--" + name);
  }

  /// @param option  with its dashes, the long name of several
  [[nodiscard]] bool has(const std::string& option) const {
    return std::find(names_.begin(), names_.end(), option) != names_.end();
  }

 private:
  std::vector<std::string> names_;
};

}  // namespace pointskin::cli
