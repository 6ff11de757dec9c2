// The commands of the program, one file each.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "given_options.hpp"

namespace pointskin::cli {

/// What the chosen command does once the whole command line has been understood. @returns the exit code
using Job = std::function<int()>;

void add_reconstruct(CLI::App& program, Job& job);
void add_info(CLI::App& program, Job& job);
void add_check(CLI::App& program, Job& job);
void add_compare(CLI::App& program, Job& job);
void add_convert(CLI::App& program, Job& job);
void add_deform(CLI::App& program, Job& job);
void add_fluid(CLI::App& program, Job& job);
void add_orient(CLI::App& program, Job& job);
void add_problems(CLI::App& program, Job& job);
void add_render(CLI::App& program, Job& job);
void add_boolean(CLI::App& program, Job& job);
void add_bench(CLI::App& program, Job& job);
void add_edit(CLI::App& program, Job& job);
void add_help(CLI::App& program, Job& job);
void add_version(CLI::App& program, Job& job);

/// "pointskin 0.1.0".
std::string version_text();

/// Adds the command `name` to `program`.
CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& description);

/// Adds `--threads N` bound to `threads`, in the group `group`.
void add_threads_option(CLI::App& command, int& threads, const std::string& group);

/// Adds `--ascii` bound to `ascii`.
void add_ascii_option(CLI::App& command, bool& ascii);

/// Adds `--overwrite` bound to `overwrite`: see FilePlan.
void add_overwrite_option(CLI::App& command, bool& overwrite);

/// Ends the definition of a command: what it does, and its --help (last in the list).
template <class Args>
void finish_command(CLI::App& command, Job& job, std::shared_ptr<Args> args, int (*run)(const Args&)) {
  command.set_help_flag("-h,--help", "print this help")->group("Help");
  command.callback([&command, &job, args, run] {
    if constexpr (requires { args->given; }) args->given = GivenOptions(command);
    job = [args, run] { return run(*args); };
  });
}

}  // namespace pointskin::cli
