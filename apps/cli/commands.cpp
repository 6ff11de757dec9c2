#include "commands.hpp"

namespace pointskin::cli {

CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& description) {
  CLI::App* command = program.add_subcommand(name, description);
  command->group("Commands");
  return command;
}

void add_threads_option(CLI::App& command, int& threads, const std::string& group) {
  command.add_option("--threads", threads, "CPU threads, 0: all that the process may use")
      ->type_name("N")
      ->group(group)
      ->capture_default_str();
}

void add_ascii_option(CLI::App& command, bool& ascii) {
  command.add_flag("--ascii", ascii, "write PLY as text")->group("Files");
}

void add_overwrite_option(CLI::App& command, bool& overwrite) {
  command.add_flag("--overwrite", overwrite, "let an output replace an input, once that has been read")->group("Files");
}

}  // namespace pointskin::cli
