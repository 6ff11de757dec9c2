#include "standard_files.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <fmt/format.h>

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

void write_all(int file, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(file, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw Error(ErrorCode::over_limit, "stdin does not fit into memory");
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

void copy_stdin_to(int file) {
  std::vector<char> block(std::size_t{1} << 20);
  for (;;) {
    const ssize_t count = ::read(STDIN_FILENO, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw Error(ErrorCode::invalid_input, fmt::format("stdin: {}", std::strerror(errno)));
    if (count == 0) return;
    write_all(file, block.data(), static_cast<std::size_t>(count));
  }
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

void make_stdin_seekable() {
  if (lseek(STDIN_FILENO, 0, SEEK_CUR) >= 0 || errno != ESPIPE) return;
  const int memory = memfd_create("pointskin-stdin", MFD_CLOEXEC);
  if (memory < 0) throw Error(ErrorCode::over_limit, fmt::format("stdin: {}", std::strerror(errno)));
  copy_stdin_to(memory);
  lseek(memory, 0, SEEK_SET);
  dup2(memory, STDIN_FILENO);
  close(memory);
}

}  // namespace pointskin::cli
