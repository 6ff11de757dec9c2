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

/// What a regular file at `path` replaces.
struct Replaced {
  std::string target;                 ///< where the links of the path lead to
  std::optional<struct stat> status;  ///< of what is there
};
Replaced replaced_by(const std::string& path) {
  if (path.empty()) fail_to_write(path, ENOENT);
  const std::string target = follow_links(path);
  const auto old = status_of(target);
  if ((old && S_ISDIR(old->st_mode)) || target.ends_with('/')) fail_to_write(path, EISDIR);
  // A rename would replace a write-protected file without asking.
  if (old && ::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0) fail_to_write(path, errno);
  return {target, old};
}

}  // namespace

bool is_stream(const std::string& path) {
  if (path == "-") return true;
  const auto status = status_of(path);
  return status && !S_ISREG(status->st_mode) && !S_ISDIR(status->st_mode);
}

/// A new file next to what it replaces, which `path` names; it vanishes unless it is renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& path) : path_(path), replaced_(replaced_by(path)), fd_(create()) {}
  /// That another process has made.
  TemporaryFile(const std::string& path, std::string name) : path_(path), name_(std::move(name)), fd_(open()) {}
  ~TemporaryFile() {
    if (!name_.empty()) ::unlink(name_.c_str());
    forget();
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Takes over owner and permissions of what is replaced. Changing the owner may be forbidden and is then left out.
  void inherit() const {
    if (!replaced_.status) return;
    const struct stat& old = *replaced_.status;
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
    if (::rename(name_.c_str(), replaced_.target.c_str()) != 0) fail_to_write(path_, errno);
    forget();
  }

  /// The file is no longer under its temporary name.
  void forget() {
    if (place_ != nullptr) place_->store(nullptr);
    place_ = nullptr;
    name_.clear();
  }

 private:
  int create() {
    constexpr int kTries = 100;
    constexpr std::size_t kLongestBase = 180;  // leaves room for the rest within the 255 bytes of a file name
    const std::string folder = folder_of(replaced_.target);
    const std::string base = replaced_.target.substr(folder.size(), kLongestBase);
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

  int open() {
    const int fd = ::open(name_.c_str(), O_WRONLY | O_CLOEXEC);
    if (fd < 0) fail_to_write(path_, errno);
    place_ = remember_unfinished(name_.c_str());
    return fd;
  }

  const std::string path_;
  const Replaced replaced_{};
  std::string name_;
  std::atomic<const char*>* place_ = nullptr;
  FileDescriptor fd_;
};

FilesTogether::FilesTogether() = default;
FilesTogether::~FilesTogether() = default;

void FilesTogether::write(exec::Cpu& ex, const std::string& path, const Blocks& blocks) {
  if (is_stream(path)) return write_stream(ex, path, blocks);
  auto file = std::make_unique<TemporaryFile>(path);
  write_to(ex, path, {blocks, file->fd(), BlockWriter::Target::file});
  file->inherit();
  file->finish();
  files_.push_back(std::move(file));
}

void FilesTogether::replace() {
  for (const auto& file : files_) file->replace();
  files_.clear();
}

FileOfMany::FileOfMany(std::unique_ptr<TemporaryFile> file) : file_(std::move(file)) {}
FileOfMany::FileOfMany(FileOfMany&&) noexcept = default;
FileOfMany::~FileOfMany() = default;

FileOfMany FileOfMany::make(const std::string& path) {
  FileOfMany file(std::make_unique<TemporaryFile>(path));
  file.file_->inherit();
  return file;
}
FileOfMany FileOfMany::open(const std::string& path, const std::string& temporary_name) {
  return FileOfMany(std::make_unique<TemporaryFile>(path, temporary_name));
}

const std::string& FileOfMany::temporary_name() const { return file_->name(); }

void FileOfMany::write(exec::Cpu& ex, const Blocks& blocks, std::int64_t first, std::int64_t last) {
  const auto make = [&](std::int64_t b, std::string& bytes) { blocks.make(first + b, bytes); };
  const Blocks part{last - first, make, {}};
  write_to(ex, file_->path(), {part, file_->fd(), BlockWriter::Target::file, blocks.place(first)});
}

void FileOfMany::finish() { file_->finish(); }
void FileOfMany::replace() { file_->replace(); }
void FileOfMany::forget() { file_->forget(); }

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
