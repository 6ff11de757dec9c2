// The program pointskin: reads the command line, runs one command, turns errors into one line and an exit code.
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "help.hpp"
#include "signals.hpp"
#include "standard_files.hpp"
#include "usage_errors.hpp"

namespace pointskin::cli {
namespace {

constexpr char kFooter[] =
    "Exit codes: 0 ok, 1 internal error, 2 usage, 3 input unreadable or invalid, 4 no usable normals,\n"
    "5 result empty, mesh not watertight or peer failed, 6 over the memory or index limit, 7 device unavailable,\n"
    "8 output not written, 130 interrupted.\n"
    "Help on a command: pointskin COMMAND --help";

void define_program(CLI::App& program, Job& job) {
  program.formatter(std::make_shared<HelpFormatter>());
  program.name("pointskin");
  program.require_subcommand(1);
  program.set_version_flag("--version", version_text(), "print the version");
  program.set_help_flag("-h,--help", "print this help");
  program.footer(kFooter);
  add_reconstruct(program, job);
  add_edit(program, job);
  add_info(program, job);
  add_check(program, job);
  add_compare(program, job);
  add_convert(program, job);
  add_deform(program, job);
  add_fluid(program, job);
  add_orient(program, job);
  add_problems(program, job);
  add_render(program, job);
  add_boolean(program, job);
  add_bench(program, job);
  add_help(program, job);
  add_version(program, job);
}

/// A usage error, with where to look.
int report_usage(const CLI::App& program, const std::vector<std::string>& args, const std::string& story) {
  const char* const separator = story.ends_with('?') ? "" : ";";
  const bool known = command_of(program, args) != nullptr && args[0] != "help";
  print_error(fmt::format("{}{} try 'pointskin{} --help'", story, separator, known ? " " + args[0] : ""));
  return static_cast<int>(ErrorCode::usage);
}

/// Parses and runs. @returns the exit code @throws Error except usage, std::exception
int run(CLI::App& program, const std::vector<std::string>& args, const Job& job) {
  try {
    program.parse(std::vector<std::string>(args.rbegin(), args.rend()));
    return job();
  } catch (const CLI::CallForHelp&) {
    write_stdout(program.help());
  } catch (const CLI::CallForVersion& version) {
    write_stdout(version.what() + std::string("\n"));
  } catch (const CLI::Error& error) {
    return report_usage(program, args, story_of(program, args, error));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) throw;
    return report_usage(program, args, story_of(command_of(program, args), error.what()));
  }
  return 0;
}

int guarded_main(const std::vector<std::string>& args) {
  try {
    CLI::App program("Oriented points in, watertight triangle mesh out.");
    Job job;
    define_program(program, job);
    return run(program, join_optional_values(args), job);
  } catch (const Error& error) {
    // The library tells in which phase it was cancelled; people care about their file.
    print_error(error.code() == ErrorCode::interrupted ? interrupted_text() : error.what());
    return static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    print_error("out of memory; use a smaller --depth or fewer points");
    return static_cast<int>(ErrorCode::over_limit);
  } catch (const std::exception& error) {
    print_error(std::string("internal error: ") + error.what());
    return static_cast<int>(ErrorCode::internal);
  }
}

}  // namespace
}  // namespace pointskin::cli

int main(int argc, char** argv) {
  pointskin::cli::hold_standard_files();
  pointskin::cli::install_signal_handlers();
  return pointskin::cli::guarded_main(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
}
