#include "io/output.hpp"

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/unfinished_files.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <optional>
#include <system_error>

#include "core/format.hpp"
#include "exec/cancel.hpp"
#include "io/block_writer.hpp"
#include "io/file_descriptor.hpp"
#include "io/source.hpp"

namespace pointskin::io {
namespace {

const char* advice_for(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space or write elsewhere";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first";
    case EACCES:
    case EPERM:
    case EROFS:
      return "check the permissions or write elsewhere";
    case EISDIR:
      return "name a file in it";
    default:
      return "check the path and the disk";
  }
}

[[noreturn]] void fail_to_write(const std::string& path, int error) {
  throw Error(ErrorCode::output_not_written,
              fmt::format("{}: cannot be written, {}; {}", path == "-" ? "stdout" : printable(path),
                          std::generic_category().message(error), advice_for(error)));
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

/// Follows symbolic links, also one whose target does not exist yet: the file is to appear where the link points.
std::string follow_links(const std::string& path) {
  constexpr int kMostLinks = 40;
  std::string target = path;
  for (int i = 0; i < kMostLinks; ++i) {
    std::array<char, PATH_MAX> buffer;
    const ssize_t length = ::readlink(target.c_str(), buffer.data(), buffer.size());
    if (length < 0) return target;  // no link, or nothing there
    const std::string link(buffer.data(), static_cast<std::size_t>(length));
    target = link.starts_with('/') ? link : folder_of(target) + link;
  }
  fail_to_write(path, ELOOP);
}

std::optional<struct stat> status_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return status;
}

/// A number that another run is unlikely to choose; O_EXCL settles the rest.
std::uint64_t random_number() {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof(number), GRND_NONBLOCK) != static_cast<ssize_t>(sizeof(number)))
    number = static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  return number;
}

/// Names of temporary files that are there now; null: a free place.
std::array<std::atomic<const char*>, 256> unfinished_files{};
static_assert(std::atomic<const char*>::is_always_lock_free, "a signal handler must not take a lock");

/// @returns the place where the name is remembered; null if all are taken
std::atomic<const char*>* remember_unfinished(const char* name) noexcept {
  for (std::atomic<const char*>& place : unfinished_files) {
    const char* nothing = nullptr;
    if (place.compare_exchange_strong(nothing, name)) return &place;
  }
  return nullptr;
}

/// Files that threads are making now, whose names are not remembered yet.
std::atomic<int> files_being_made{0};
/// The process is about to end: nobody would remove another file.
std::atomic<bool> process_ends{false};

/// While one is there, a process that ends waits for its file's name.
class MakingFile {
 public:
  MakingFile() { ++files_being_made; }
  ~MakingFile() { --files_being_made; }
  MakingFile(const MakingFile&) = delete;
  MakingFile& operator=(const MakingFile&) = delete;
};

/// Runs the writer; what the system refuses becomes an Error about `path`.
void write_to(exec::Cpu& ex, const std::string& path, BlockWriter&& writer) {
  try {
    writer.run(ex);
  } catch (const std::system_error& error) {
    fail_to_write(path, error.code().value());
  }
}

/// Opens a device, or a pipe as soon as somebody reads it; never blocks.
int open_stream(const std::string& path) {
  constexpr int kLookEveryMs = 50;
  while (true) {
    const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd >= 0) return fd;
    const int error = errno;
    const auto status = status_of(path);
    const bool nobody_reads = error == ENXIO && status && S_ISFIFO(status->st_mode);
    if (!nobody_reads && error != EINTR) fail_to_write(path, error);
    exec::throw_if_cancelled();
    ::poll(nullptr, 0, kLookEveryMs);
  }
}

void write_stream(exec::Cpu& ex, const std::string& path, const Blocks& blocks) {
  if (path == "-") return write_to(ex, path, {blocks, STDOUT_FILENO, BlockWriter::Target::stream});
  FileDescriptor file(open_stream(path));
  write_to(ex, path, {blocks, file.get(), BlockWriter::Target::stream});
  if (file.close() != 0 && errno != EINTR) fail_to_write(path, errno);
}

}  // namespace

bool is_stream(const std::string& path) {
  if (path == "-") return true;
  const auto status = status_of(path);
  return status && !S_ISREG(status->st_mode) && !S_ISDIR(status->st_mode);
}

/// A new file next to `target`, which `path` names; it vanishes unless it is renamed.
class FilesTogether::TemporaryFile {
 public:
  TemporaryFile(const std::string& path, std::string target) : path_(path), target_(std::move(target)), fd_(create()) {}
  ~TemporaryFile() {
    if (!name_.empty()) ::unlink(name_.c_str());
    if (place_ != nullptr) place_->store(nullptr);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] int fd() const { return fd_.get(); }

  /// Takes over owner and permissions. Changing the owner may be forbidden and is then left out.
  void inherit(const struct stat& old) const {
    const bool same_owner = old.st_uid == ::geteuid() && old.st_gid == ::getegid();
    if (!same_owner && ::fchown(fd(), old.st_uid, old.st_gid) != 0) errno = 0;
    if (::fchmod(fd(), old.st_mode & 0777) != 0) fail_to_write(path_, errno);
  }

  /// Brings the bytes to the disk before the name: a crash in between must not leave an empty file.
  void finish() {
    while (::fsync(fd()) != 0 && errno != EINVAL)  // EINVAL: nothing to synchronise
      if (errno != EINTR) fail_to_write(path_, errno);
    exec::throw_if_cancelled();
    if (fd_.close() != 0 && errno != EINTR) fail_to_write(path_, errno);
  }

  void replace() {
    if (::rename(name_.c_str(), target_.c_str()) != 0) fail_to_write(path_, errno);
    if (place_ != nullptr) place_->store(nullptr);
    place_ = nullptr;
    name_.clear();
  }

 private:
  int create() {
    constexpr int kTries = 100;
    constexpr std::size_t kLongestBase = 180;  // leaves room for the rest within the 255 bytes of a file name
    const std::string folder = folder_of(target_);
    const std::string base = target_.substr(folder.size(), kLongestBase);
    const MakingFile making;
    if (process_ends) fail_to_write(path_, ECANCELED);
    for (int i = 0; i < kTries; ++i) {
      std::string name = fmt::format("{}.{}.{}-{:016x}.tmp", folder, base, ::getpid(), random_number());
      const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd >= 0) {
        name_ = std::move(name);
        place_ = remember_unfinished(name_.c_str());
        return fd;
      }
      if (errno != EEXIST && errno != EINTR) fail_to_write(path_, errno);
    }
    fail_to_write(path_, EEXIST);
  }

  const std::string path_;
  const std::string target_;
  std::string name_;
  std::atomic<const char*>* place_ = nullptr;
  FileDescriptor fd_;
};

FilesTogether::FilesTogether() = default;
FilesTogether::~FilesTogether() = default;

void FilesTogether::write(exec::Cpu& ex, const std::string& path, const Blocks& blocks) {
  if (is_stream(path)) return write_stream(ex, path, blocks);
  if (path.empty()) fail_to_write(path, ENOENT);
  const std::string target = follow_links(path);
  const auto old = status_of(target);
  if ((old && S_ISDIR(old->st_mode)) || target.ends_with('/')) fail_to_write(path, EISDIR);
  // A rename would replace a write-protected file without asking.
  if (old && ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0) fail_to_write(path, errno);
  auto file = std::make_unique<TemporaryFile>(path, target);
  write_to(ex, path, {blocks, file->fd(), BlockWriter::Target::file});
  if (old) file->inherit(*old);
  file->finish();
  files_.push_back(std::move(file));
}

void FilesTogether::replace() {
  for (const auto& file : files_) file->replace();
  files_.clear();
}

void write_blocks(exec::Cpu& ex, const std::string& path, const Blocks& blocks) {
  FilesTogether file;
  file.write(ex, path, blocks);
  file.replace();
}

}  // namespace pointskin::io

namespace pointskin {

void remove_unfinished_files() noexcept {
  constexpr int kMostWaits = 100;
  io::process_ends = true;
  // The files that are being made have their names in microseconds; unless this is a signal handler in that very thread.
  for (int i = 0; i < kMostWaits && io::files_being_made > 0; ++i) ::poll(nullptr, 0, 1);
  for (const std::atomic<const char*>& place : io::unfinished_files)
    if (const char* const name = place.load(); name != nullptr) ::unlink(name);
}

void write_file_atomically(const std::string& path, const std::string& bytes) {
  exec::Cpu ex(1);
  const auto all = [&](std::int64_t /*block*/, std::string& to) { to = bytes; };
  io::write_blocks(ex, path, {1, all});
}

}  // namespace pointskin
