// The command lines of the small programs of this folder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pointskin::bench {

/// Walks over the words of a command line.
class Arguments {
 public:
  explicit Arguments(const std::vector<std::string>& words) : words_(words) {}

  /// The next word, or nothing at the end.
  std::optional<std::string> next();

  /// The word after the option that next() returned.
  /// @throws Error usage, naming the option, if it is missing or (below) no such number
  std::string value();
  std::int64_t whole_number();
  double number();

  /// @throws Error usage, saying that the word of the last next() is not known
  [[noreturn]] void refuse() const;

 private:
  const std::vector<std::string>& words_;
  std::size_t at_ = 0;
};

/// Runs `body` over the words of the command line; an exception becomes one line on stderr and its exit code.
int run_main(const char* program, int argc, char** argv, int (*body)(const std::vector<std::string>&));

}  // namespace pointskin::bench
