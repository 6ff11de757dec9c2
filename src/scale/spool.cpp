#include "scale/spool.hpp"

#include <pointskin/error.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/format.hpp"
#include "exec/cancel.hpp"
#include "io/source.hpp"

namespace pointskin::scale {
namespace {

constexpr std::int64_t kAtOnce = std::int64_t{64} << 20;  // bytes; cancelling is looked for in between
constexpr std::int64_t kOfAThread = 4 << 20;

constexpr std::string_view kName = ".pointskin_", kAnyLetters = "XXXXXX";

/// A new file without a name, or -1; where a file system cannot do without names, of the name that is set.
int make_file(const std::string& folder, SpoolName named, std::string& name) {
  const int without_name = O_TMPFILE | O_RDWR | O_CLOEXEC | (named == SpoolName::never ? O_EXCL : 0);
  const int file = ::open(folder.c_str(), without_name, 0600);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return file;
  std::string path = fmt::format("{}/{}{}", folder, kName, kAnyLetters);
  const int named_file = ::mkostemp(path.data(), O_CLOEXEC);
  if (named_file >= 0) name = path.substr(folder.size() + 1);
  return named_file;
}

}  // namespace

Spool::Spool(std::string folder, std::int64_t bytes, SpoolName named)
    : folder_(std::move(folder)), bytes_(bytes), file_(make_file(folder_, named, name_)) {
  const int error = errno;
  if (named == SpoolName::never) hide();
  if (!file_.valid()) fail("no temporary file can be made", error);
  try {
    reserve();
  } catch (...) {
    hide();
    throw;
  }
}

std::unique_ptr<Spool> Spool::open(const std::string& folder, const std::string& name, std::int64_t bytes) {
  std::unique_ptr<Spool> spool(new Spool(folder, bytes, ::open((folder + "/" + name).c_str(), O_RDWR | O_CLOEXEC)));
  if (!spool->file_.valid())
    spool->fail("a temporary file of another process is not there; all need one folder that they share", errno);
  return spool;
}

const std::string& Spool::show() {
  const std::string file = fmt::format("/proc/self/fd/{}", file_.get());
  std::random_device random;
  while (name_.empty()) {
    const std::string name = fmt::format("{}{:08x}{:08x}", kName, random(), random());
    if (::linkat(AT_FDCWD, file.c_str(), AT_FDCWD, (folder_ + "/" + name).c_str(), AT_SYMLINK_FOLLOW) == 0)
      name_ = name;
    else if (errno != EEXIST)
      fail("a temporary file cannot be named", errno);
  }
  return name_;
}

void Spool::hide() {
  if (!name_.empty()) ::unlink((folder_ + "/" + name_).c_str());
  name_.clear();
}

void Spool::fail(const char* what, int error) const {
  throw Error(ErrorCode::output_not_written,
              fmt::format("{}: {}, {}; choose another folder for temporary files", io::printable(folder_), what,
                          std::generic_category().message(error)));
}

void Spool::reserve() const {
  if (bytes_ == 0) return;
  const std::string what =
      fmt::format("there is no room for {:.3g} GB of temporary data", 1e-9 * static_cast<double>(bytes_));
  while (::fallocate(file_.get(), 0, 0, bytes_) != 0) {
    if (errno == EINTR) {
      exec::throw_if_cancelled();
      continue;
    }
    if (errno != EOPNOTSUPP && errno != ENOSYS) fail(what.c_str(), errno);
    // A file system that cannot reserve: what is free now must do.
    struct statvfs room {};
    if (::fstatvfs(file_.get(), &room) == 0 &&
        static_cast<double>(room.f_bavail) * static_cast<double>(room.f_frsize) < static_cast<double>(bytes_))
      fail(what.c_str(), ENOSPC);
    if (::ftruncate(file_.get(), bytes_) != 0) fail(what.c_str(), errno);
    return;
  }
}

/// Writing behind the end of a file that another program has cut would fill it with zeros, and hide that it was.
bool Spool::is_cut() const {
  struct stat status {};
  return ::fstat(file_.get(), &status) == 0 && status.st_size < bytes_;
}

template <class Move>
void Spool::move_all(std::int64_t count, const char* what, const Move& move) const {
  std::int64_t moved = 0;
  while (moved < count) {
    exec::throw_if_cancelled();
    if (is_cut()) fail(what, EIO);
    const ssize_t now = move(moved, static_cast<std::size_t>(std::min(count - moved, kAtOnce)));
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) fail(what, now < 0 ? errno : EIO);
    moved += now;
  }
}

void Spool::write(std::int64_t at, const void* data, std::int64_t count) const {
  move_all(count, "temporary data cannot be written", [&](std::int64_t done, std::size_t bytes) {
    return ::pwrite(file_.get(), static_cast<const char*>(data) + done, bytes, at + done);
  });
}

void Spool::read(std::int64_t at, void* data, std::int64_t count) const {
  move_all(count, "temporary data cannot be read", [&](std::int64_t done, std::size_t bytes) {
    return ::pread(file_.get(), static_cast<char*>(data) + done, bytes, at + done);
  });
}

void Spool::write(exec::Cpu& ex, std::int64_t at, const void* data, std::int64_t count) const {
  ex.run_blocks((count + kOfAThread - 1) / kOfAThread, [&](std::int64_t block) {
    const std::int64_t done = block * kOfAThread;
    write(at + done, static_cast<const char*>(data) + done, std::min(kOfAThread, count - done));
  });
}

void Spool::read(exec::Cpu& ex, std::int64_t at, void* data, std::int64_t count) const {
  ex.run_blocks((count + kOfAThread - 1) / kOfAThread, [&](std::int64_t block) {
    const std::int64_t done = block * kOfAThread;
    read(at + done, static_cast<char*>(data) + done, std::min(kOfAThread, count - done));
  });
}

}  // namespace pointskin::scale
