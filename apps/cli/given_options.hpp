// Which options a command line names.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace pointskin::cli {

/// The options that were given, whatever their values. Arguments of a command that have a member `given` of this type
/// get it filled in (make_command).
class GivenOptions {
 public:
  GivenOptions() = default;
  /// @param names  all long names of the options, with their dashes
  explicit GivenOptions(std::vector<std::string> names) : names_(std::move(names)) {}

  /// @param option  with its dashes, the long name of several
  [[nodiscard]] bool has(const std::string& option) const {
    return std::find(names_.begin(), names_.end(), option) != names_.end();
  }

 private:
  std::vector<std::string> names_;
};

}  // namespace pointskin::cli
