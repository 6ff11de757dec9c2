// The program pointskin: reads the command line, runs one command, turns errors into one line and an exit code.
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/unfinished_files.hpp>

#include "args.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "exhaustion.hpp"
#include "ranks.hpp"
#include "signals.hpp"
#include "standard_files.hpp"

namespace pointskin::cli {
namespace {

/// Tells what no command expected. @returns the exit code: a thread that the system refuses is a limit, all else a bug
int told(const std::exception& error) {
  const auto* const of_system = dynamic_cast<const std::system_error*>(&error);
  if (of_system != nullptr && of_system->code() == std::errc::resource_unavailable_try_again) {
    print_error("the system does not let more threads be made; use fewer --threads");
    return static_cast<int>(ErrorCode::over_limit);
  }
  print_error(std::string("internal error: ") + error.what());
  return static_cast<int>(ErrorCode::internal);
}

int guarded_main(const std::vector<std::string>& args) {
  const InterruptScope scope;
  try {
    if (is_one_of_ranks() && (args.empty() || args.front() != "reconstruct"))
      throw_usage("only reconstruct works on several ranks; start all other commands without a launcher of MPI");
    return run_command_line(all_commands(), join_optional_values(args));
  } catch (const Error& error) {
    // The library tells in which phase it was cancelled; people care about their file.
    if (tells_of(error.code())) print_error(error.code() == ErrorCode::interrupted ? interrupted_text() : error.what());
    return static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::filesystem::filesystem_error& error) {  // as where the working folder has been removed
    print_error(fmt::format("{}: cannot be found, {}; check the path and the working folder", error.path1().string(),
                            error.code().message()));
    return static_cast<int>(ErrorCode::invalid_input);
  } catch (const std::exception& error) {
    return told(error);
  }
}

/// Also where telling of another error takes memory that is not there. Of several threads at once, the first tells and ends the
/// process; the others give it time for that.
int without_memory() noexcept {
  static std::atomic_flag is_told;
  if (!is_told.test_and_set())
    print_out_of_memory();
  else
    sleep(1);
  return static_cast<int>(ErrorCode::over_limit);
}

std::terminate_handler library_terminate = std::abort;  ///< tells of other exceptions

/// Where an exception leaves a function that may throw none, as there are in libraries, or cannot be thrown for want of
/// memory, nothing can be unwound: tell what was the matter, and end.
[[noreturn]] void end_at_once() {
  if (memory_ran_out()) {
    remove_unfinished_files();  // other threads may be writing
    _exit(without_memory());
  }
  library_terminate();
  std::abort();
}

}  // namespace
}  // namespace pointskin::cli

int main(int argc, char** argv) {
  pointskin::cli::hold_standard_files();
  pointskin::cli::install_signal_handlers();
  pointskin::cli::watch_memory();
  pointskin::cli::library_terminate = std::set_terminate(pointskin::cli::end_at_once);
  try {
    return pointskin::cli::end_with_ranks(
        pointskin::cli::guarded_main(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc)));
  } catch (const std::bad_alloc&) {
    return pointskin::cli::end_with_ranks(pointskin::cli::without_memory());
  }
}
