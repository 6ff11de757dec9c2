#include "scale/spool.hpp"

#include <pointskin/error.hpp>

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "core/format.hpp"
#include "exec/cancel.hpp"
#include "io/source.hpp"

namespace pointskin::scale {
namespace {

constexpr std::int64_t kAtOnce = std::int64_t{64} << 20;  // bytes; cancelling is looked for in between
constexpr std::int64_t kOfAThread = 4 << 20;

/// A new file without a name, or -1.
int make_file(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC | O_EXCL, 0600);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return file;
  std::string name = folder + "/.pointskin_XXXXXX";  // file systems that cannot do without a name
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace

Spool::Spool(std::string folder, std::int64_t bytes)
    : folder_(std::move(folder)), bytes_(bytes), file_(make_file(folder_)) {
  if (!file_.valid()) fail("no temporary file can be made", errno);
  reserve();
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

template <class Move>
void Spool::move_all(std::int64_t count, const char* what, const Move& move) const {
  std::int64_t moved = 0;
  while (moved < count) {
    exec::throw_if_cancelled();
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
