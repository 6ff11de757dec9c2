// The commands of the program, one file each.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "given_options.hpp"
#include "option_table.hpp"

namespace pointskin::cli {

/// What a command is called, and what --help says before and after its options.
struct CommandTexts {
  std::string name, description, footer{};
};

/// A command of the program. Its table sets variables that `run` works with.
struct Command {
  CommandTexts texts;
  OptionTable options;
  std::function<int(const GivenOptions&)> run;  ///< @returns the exit code
};

/// A command with arguments of its own. @param options  the table that sets them
template <class Args>
Command make_command(CommandTexts texts, OptionTable (*options)(Args&), int (*run)(const Args&),
                     const std::shared_ptr<Args>& held = std::make_shared<Args>()) {
  return {std::move(texts), options(*held), [held, run](const GivenOptions& given) {
            if constexpr (requires { held->given; }) held->given = given;
            return run(*held);
          }};
}

/// In the order of --help, but for `help` and `version`, which the command line has itself.
std::vector<Command> all_commands();

Command reconstruct_command();
Command edit_command();
Command info_command();
Command check_command();
Command compare_command();
Command convert_command();
Command deform_command();
Command fluid_command();
Command orient_command();
Command problems_command();
Command render_command();
Command boolean_command();
Command studio_command();
Command formats_command();
Command bench_command();

}  // namespace pointskin::cli
