#include "io/input.hpp"

#include <pointskin/error.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "exec/cancel.hpp"
#include "io/file_descriptor.hpp"

namespace pointskin::io {
namespace {

[[noreturn]] void fail_to_read(const std::string& name, int error) {
  const char* advice = error == ENOENT   ? "check the path"
                       : error == EACCES ? "check the permissions"
                                         : "check the disk and the path";
  fail({name, {}}, "cannot be read, " + std::generic_category().message(error), advice);
}

}  // namespace

Input::Input(const std::string& path) : name_(path == "-" ? "stdin" : path) {
  if (path == "-") {
    read_all(STDIN_FILENO);
  } else {
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // no waiting for pipes
    if (!file.valid()) fail_to_read(name_, errno);
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) fail_to_read(name_, errno);
    if (S_ISDIR(status.st_mode)) fail({name_, {}}, "is a folder", "name a file in it");
    if (S_ISREG(status.st_mode) && status.st_size > 0) {
      const auto size = static_cast<std::size_t>(status.st_size);
      void* mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
      if (mapping != MAP_FAILED) {
        mapping_ = mapping;
        mapped_bytes_ = size;
      }
    }
    // Some file systems cannot map, and files of /proc claim to be empty.
    if (mapping_ == nullptr) read_all(file.get());
  }
  if (source().bytes.empty()) fail({name_, {}}, "is empty", "check the program that wrote it");
}

Input::~Input() {
  if (mapping_ != nullptr) ::munmap(mapping_, mapped_bytes_);
}

Source Input::source() const {
  if (mapping_ != nullptr) return {name_, {static_cast<const char*>(mapping_), mapped_bytes_}};
  return {name_, memory_};
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
