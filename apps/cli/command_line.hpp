// The command line: reads it by the tables of the commands, prints help, tells what is wrong, runs a command.
#pragma once

#include <string>
#include <vector>

#include "commands.hpp"

namespace pointskin::cli {

/// Parses `args` and runs one of `commands`, or `help` or `version`. Errors of usage are told on stderr.
/// @returns the exit code
/// @throws Error  all others of the command, std::exception
int run_command_line(const std::vector<Command>& commands, const std::vector<std::string>& args);

}  // namespace pointskin::cli
