#include "standard_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include <pointskin/error.hpp>

namespace pointskin::cli {
namespace {

/// The lowest number that is free is given: whoever is called for 0, 1 and 2 in turn gets that one.
void hold(int number, int access) {
  if (fcntl(number, F_GETFD) >= 0 || errno != EBADF) return;
  int file = open("/dev/null", access);
  if (file < 0) file = open("/", O_PATH);  // neither read nor written either, and there everywhere
  if (file != number) std::_Exit(static_cast<int>(ErrorCode::internal));
}

}  // namespace

void hold_standard_files() {
  hold(STDIN_FILENO, O_WRONLY);
  hold(STDOUT_FILENO, O_RDONLY);
  hold(STDERR_FILENO, O_RDONLY);
}

bool stdout_is_open() {
  const int flags = fcntl(STDOUT_FILENO, F_GETFL);
  return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY && (flags & O_PATH) == 0;
}

}  // namespace pointskin::cli
