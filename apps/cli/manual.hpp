// Manual pages and shell completion, from the same parser as --help.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace pointskin::cli {

/// A manual page in roff, section 1: of the program, or of one of its commands.
/// @param command  null: the program
std::string manual_of(const CLI::App& program, const CLI::App* command);

/// What a shell reads to complete commands, options and files.
/// @param shell  "bash", "zsh" or "fish" @throws Error usage for another one
std::string completion_of(const CLI::App& program, const std::string& shell);

}  // namespace pointskin::cli
