// Errors of the library: one exception type whose code equals the command line's exit code.
#pragma once

#include <stdexcept>
#include <string>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// What went wrong. The numeric value is the exit code of the `pointskin` program.
enum class ErrorCode : int {
  internal = 1,            ///< a bug or a failed internal check
  usage = 2,               ///< an argument or option outside its range
  invalid_input = 3,       ///< a file that cannot be read or is not what it claims
  no_normals = 4,          ///< points without usable normals
  empty_result = 5,        ///< nothing to reconstruct, or a surface without triangles
  over_limit = 6,          ///< more memory or more indices than allowed
  device_unavailable = 7,  ///< the asked-for device does not exist or failed
  output_not_written = 8,  ///< the output could not be written; nothing was replaced
  interrupted = 130,       ///< cancelled by the caller or by a signal
};

/// An error with a code and a one-line story: what failed, where, and what to do about it.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& story) : std::runtime_error(story), code_(code) {}

  [[nodiscard]] ErrorCode code() const noexcept { return code_; }

  /// The same error with "; while `context`" appended to its story.
  [[nodiscard]] Error while_doing(const std::string& context) const {
    return {code_, std::string(what()) + "; while " + context};
  }

 private:
  ErrorCode code_;
};

}  // namespace pointskin
