#include "io/input.hpp"

#include <pointskin/error.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "exec/cancel.hpp"

namespace pointskin::io {

void fail_to_read(const std::string& name, int error) {
  const char* advice = error == ENOENT   ? "check the path"
                       : error == EACCES ? "check the permissions"
                                         : "check the disk and the path";
  fail({name, {}}, "cannot be read, " + std::generic_category().message(error), advice);
}

namespace {

/// Does not wait until somebody opens a pipe to write into it.
int open_input(const std::string& path) {
  return path == "-" ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                     : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
}

/// False for a stdin of which another program has read a part.
bool is_at_its_beginning(int fd) { return ::lseek(fd, 0, SEEK_CUR) == 0; }

}  // namespace

Input::Input(const std::string& path) : name_(path == "-" ? "stdin" : path), file_(open_input(path)) {
  if (!file_.valid()) fail_to_read(name_, errno);
  struct stat status {};
  if (::fstat(file_.get(), &status) != 0) fail_to_read(name_, errno);
  if (S_ISDIR(status.st_mode)) fail({name_, {}}, "is a folder", "name a file in it");
  if (S_ISREG(status.st_mode) && status.st_size > 0 && is_at_its_beginning(file_.get()))
    mapping_.map(file_.get(), static_cast<std::size_t>(status.st_size));
  // Some file systems cannot map, and files of /proc claim to be empty.
  if (!mapping_.mapped()) read_all(file_.get());
  if (source().bytes.empty()) fail({name_, {}}, "is empty", "check the program that wrote it");
}

Source Input::source() const {
  if (mapping_.mapped()) return {name_, mapping_.bytes()};
  return {name_, memory_};
}

void Input::read_at(std::size_t at, std::size_t bytes, char* out) const {
  if (!mapping_.mapped()) {
    std::copy_n(memory_.data() + at, bytes, out);
    return;
  }
  while (bytes > 0) {
    const ssize_t got = ::pread(file_.get(), out, bytes, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_to_read(name_, errno);
    if (got == 0) fail_as_cut();
    at += static_cast<std::size_t>(got);
    out += got;
    bytes -= static_cast<std::size_t>(got);
  }
}

void Input::fail_as_cut() const {
  fail({name_, {}}, "was cut short while it was read", "check the program that writes it");
}

void Input::check_whole() const {
  if (!mapping_.mapped()) return;
  struct stat status {};
  const bool cut =
      ::fstat(file_.get(), &status) == 0 && static_cast<std::size_t>(status.st_size) < mapping_.bytes().size();
  if (cut) fail_as_cut();
  if (mapping_.lost_bytes())
    fail({name_, {}}, "could not be read to its end", "check the disk, and what writes the file");
}

void Input::read_all(int fd) {
  constexpr std::size_t kFirstStep = std::size_t{1} << 16;
  std::size_t used = 0;
  while (true) {
    if (used == memory_.size()) memory_.resize(std::max(kFirstStep, 2 * used));
    // Signals are taken while waiting here: ThreadSanitizer holds them back during read.
    constexpr int kLookEveryMs = 100;
    pollfd input = {fd, POLLIN, 0};
    const int ready = ::poll(&input, 1, kLookEveryMs);
    exec::throw_if_cancelled();
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t got = ::read(fd, memory_.data() + used, memory_.size() - used);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got < 0) fail_to_read(name_, errno);
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
  }
  memory_.resize(used);
}

}  // namespace pointskin::io
