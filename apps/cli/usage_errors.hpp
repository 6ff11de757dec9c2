// Usage errors in the words of the program: which option or command is meant, and which may have been.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace pointskin::cli {

/// The command of `program` that `args` begin with; null if they begin with something else.
const CLI::App* command_of(const CLI::App& program, const std::vector<std::string>& args);

/// `name` in quotes is no command, and which may have been meant, or which there are.
std::string no_such_command(const CLI::App& program, const std::string& name);

/// What to tell when the command line `args` could not be parsed.
std::string story_of(const CLI::App& program, const std::vector<std::string>& args, const CLI::Error& error);

/// What to tell when the library refuses an option: as it stands on the command line, with the value that it got.
/// "option samples_per_node must be in 0..100" becomes "--samples-per-node must be in 0..100, but is 101".
std::string story_of(const CLI::App* command, const std::string& library_story);

}  // namespace pointskin::cli
