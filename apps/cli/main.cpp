// The program pointskin: reads the command line, runs one command, turns errors into one line and an exit code.
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "command_line.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "signals.hpp"
#include "standard_files.hpp"

namespace pointskin::cli {
namespace {

int guarded_main(const std::vector<std::string>& args) {
  const InterruptScope scope;
  try {
    return run_command_line(all_commands(), join_optional_values(args));
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
