// pointskin help, pointskin version: what --help and --version print, as commands.
#include <memory>
#include <string>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "commands.hpp"
#include "console.hpp"
#include "usage_errors.hpp"

namespace pointskin::cli {
namespace {

/// The help on `topic`, or on the program for none. @throws Error usage if there is no such command
std::string help_on(const CLI::App& program, const std::string& topic) {
  const auto make = [&program](const CLI::App& app, const std::string& name) {
    return program.get_formatter()->make_help(&app, name, CLI::AppFormatMode::Normal);
  };
  if (topic.empty()) return make(program, program.get_name());
  const CLI::App* const command = command_of(program, {topic});
  if (command == nullptr) throw Error(ErrorCode::usage, no_such_command(program, topic));
  return make(*command, program.get_name() + " " + topic);
}

}  // namespace

void add_help(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "help", "Print the help on the program, or on a command.");
  auto topic = std::make_shared<std::string>();
  command->add_option("COMMAND", *topic, "the command [default the program]");
  command->set_help_flag("-h,--help", "print this help")->group("Help");
  command->callback([&program, &job, topic] {
    job = [&program, topic] {
      write_stdout(help_on(program, *topic));
      return 0;
    };
  });
}

void add_version(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "version", "Print the version.");
  command->set_help_flag("-h,--help", "print this help")->group("Help");
  command->callback([&job] {
    job = [] {
      write_stdout(version_text() + "\n");
      return 0;
    };
  });
}

std::string version_text() { return std::string("pointskin ") + POINTSKIN_VERSION; }

}  // namespace pointskin::cli
