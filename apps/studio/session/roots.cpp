// openat2(2); the same by hand: "Openat(2) and friends", https://lwn.net/Articles/796868.
#include "studio/session/roots.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <system_error>
#include <tuple>

#include <pointskin/error.hpp>

#include "studio/session/utf8.hpp"

namespace pointskin::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestPath = 4096, kLongestName = 255;

[[noreturn]] void refuse(ErrorCode code, const fs::path& path, const std::string& why) {
  throw Error(code, path.string().substr(0, 200) + ": " + why);
}

/// What an errno of looking up a name means to people.
std::string reason_of(int error) {
  if (error == EXDEV || error == ELOOP) return "leads over a link; links are not followed here";
  return "cannot be opened, " + std::generic_category().message(error);
}

int open_by_openat2(int folder, const fs::path& below, int flags) {
  open_how how = {};
  how.flags = static_cast<std::uint64_t>(flags);
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_MAGICLINKS;
  return static_cast<int>(syscall(SYS_openat2, folder, below.c_str(), &how, sizeof how));
}

int open_by_parts(int root, const fs::path& below, int flags) {
  Handle folder(openat(root, ".", O_PATH | O_DIRECTORY | O_CLOEXEC));
  for (auto part = below.begin(); part != below.end() && folder.valid(); ++part) {
    if (std::next(part) == below.end()) return openat(folder.number(), part->c_str(), flags | O_NOFOLLOW);
    folder = Handle(openat(folder.number(), part->c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  }
  return -1;
}

bool is_no_openat2(int error) { return error == ENOSYS || error == EPERM; }  // EPERM: of old container runtimes

std::string pinned(const Handle& folder, const std::string& name) {
  return "/proc/self/fd/" + std::to_string(folder.number()) + "/" + name;
}

std::string with_path(std::string story, const std::string& pinned, const fs::path& path) {
  for (std::size_t at = 0; (at = story.find(pinned, at)) != std::string::npos; at += path.string().size())
    story.replace(at, pinned.size(), path.string());
  return story;
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName && name != "." && name != ".." &&
         name.find('/') == std::string::npos && name.find('\0') == std::string::npos;
}

/// @returns false for what is not shown
bool describe(int folder, const std::string& name, FolderEntry& entry) {
  struct stat about = {};
  if (name.starts_with('.') || !is_utf8(name)) return false;
  if (fstatat(folder, name.c_str(), &about, AT_SYMLINK_NOFOLLOW) != 0) return false;
  if (!S_ISDIR(about.st_mode) && !S_ISREG(about.st_mode)) return false;
  entry = {name, S_ISDIR(about.st_mode), S_ISREG(about.st_mode) ? about.st_size : 0};
  return true;
}

}  // namespace

Handle::~Handle() {
  if (number_ >= 0) close(number_);
}

std::string ReadableFile::pinned_path() const { return pinned(folder_, path_.filename()); }

void ReadableFile::check_unchanged() const {
  struct stat held = {}, named = {};
  const bool same = fstat(file_.number(), &held) == 0 &&
                    fstatat(folder_.number(), path_.filename().c_str(), &named, AT_SYMLINK_NOFOLLOW) == 0 &&
                    held.st_dev == named.st_dev && held.st_ino == named.st_ino;
  if (!same) refuse(ErrorCode::invalid_input, path_, "was exchanged while it was read; open it again");
}

std::string ReadableFile::readable(std::string story) const {
  return with_path(std::move(story), pinned_path(), path_);
}

WritableFile::WritableFile(fs::path path, Handle folder, int mode)
    : path_(std::move(path)), folder_(std::move(folder)), mode_(mode) {
  std::string form = pinned(folder_, ".pointskin-XXXXXX");
  if (mkdtemp(form.data()) == nullptr)
    refuse(ErrorCode::output_not_written, path_, "cannot be written, " + std::generic_category().message(errno));
  own_name_ = fs::path(form).filename();
  own_ = Handle(openat(folder_.number(), own_name_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
}

WritableFile::~WritableFile() {
  if (!folder_.valid()) return;  // moved away
  unlinkat(own_.number(), path_.filename().c_str(), 0);
  unlinkat(folder_.number(), own_name_.c_str(), AT_REMOVEDIR);
}

std::string WritableFile::pinned_path() const { return pinned(own_, path_.filename()); }

std::int64_t WritableFile::commit() {
  struct stat about = {};
  const std::string name = path_.filename();
  const int from = own_.number();
  if (fstatat(from, name.c_str(), &about, AT_SYMLINK_NOFOLLOW) != 0 || !S_ISREG(about.st_mode))
    refuse(ErrorCode::output_not_written, path_, "nothing was written");
  if (mode_ >= 0 && fchmodat(from, name.c_str(), static_cast<mode_t>(mode_), 0) != 0) errno = 0;  // as it can be
  if (renameat2(from, name.c_str(), folder_.number(), name.c_str(), mode_ >= 0 ? 0 : RENAME_NOREPLACE) != 0)
    refuse(ErrorCode::output_not_written, path_,
           errno == EEXIST ? "is there already" : "cannot be written, " + std::generic_category().message(errno));
  return about.st_size;
}

std::string WritableFile::readable(std::string story) const {
  return with_path(std::move(story), pinned_path(), path_);
}

Roots::Roots(const std::vector<fs::path>& folders, Lookup lookup) : lookup_(lookup) {
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::path whole = fs::canonical(folder, error);
    Handle handle(error ? -1 : open(whole.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!handle.valid()) refuse(ErrorCode::usage, folder, "is no folder that can be read; see --root");
    if (std::find(folders_.begin(), folders_.end(), whole) != folders_.end()) continue;
    folders_.push_back(whole);
    handles_.push_back(std::move(handle));
  }
  if (folders_.empty()) throw Error(ErrorCode::usage, "there is no folder to read from; see --root");
}

// Of two roots of which one lies in the other, either will do. ".." is refused here: whether it stays below would depend
// on links, and no page of ours sends it.
Roots::Place Roots::place_of(const fs::path& path) const {
  const std::string& text = path.native();
  if (text.find('\0') != std::string::npos) refuse(ErrorCode::invalid_input, "a path", "holds a zero byte");
  if (text.size() > kLongestPath) refuse(ErrorCode::invalid_input, path, "is too long");
  if (std::find(path.begin(), path.end(), "..") != path.end())
    refuse(ErrorCode::invalid_input, path, "lies outside of the folders of --root");
  const auto trimmed = [](const fs::path& below) {
    const fs::path normal = below.lexically_normal();
    return normal.has_filename() ? normal : normal.parent_path();
  };
  if (path.is_relative()) return {0, path.empty() ? "." : trimmed(path)};
  const fs::path whole = trimmed(path);
  for (std::size_t root = 0; root < folders_.size(); ++root) {
    const auto [end, rest] = std::mismatch(folders_[root].begin(), folders_[root].end(), whole.begin(), whole.end());
    if (end == folders_[root].end()) return {root, whole.lexically_relative(folders_[root])};
  }
  refuse(ErrorCode::invalid_input, path, "lies outside of the folders of --root");
}

Handle Roots::open_below(const Place& place, int flags) const {
  const int root = handles_[place.root].number();
  if (lookup_ == Lookup::automatic) {
    Handle handle(open_by_openat2(root, place.below, flags));
    if (handle.valid() || !is_no_openat2(errno)) return handle;
  }
  return Handle(open_by_parts(root, place.below, flags));
}

Handle Roots::open_folder(const Place& place) const {
  Handle folder = open_below(place, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (!folder.valid()) refuse(ErrorCode::invalid_input, folders_[place.root] / place.below, reason_of(errno));
  return folder;
}

std::vector<FolderEntry> Roots::list(const fs::path& folder) const {
  constexpr std::size_t kMost = 10'000;
  const Handle held = open_folder(place_of(folder));
  // fdopendir closes what it is given.
  const std::unique_ptr<DIR, int (*)(DIR*)> stream(fdopendir(openat(held.number(), ".", O_RDONLY | O_CLOEXEC)),
                                                   closedir);
  if (stream == nullptr) refuse(ErrorCode::invalid_input, folder, reason_of(errno));
  std::vector<FolderEntry> entries;
  FolderEntry entry;
  while (entries.size() < kMost) {
    const dirent* const found = readdir(stream.get());  // NOLINT(concurrency-mt-unsafe): the stream is ours
    if (found == nullptr) break;
    if (describe(held.number(), found->d_name, entry)) entries.push_back(entry);
  }
  std::sort(entries.begin(), entries.end(), [](const FolderEntry& a, const FolderEntry& b) {
    return std::tie(b.is_folder, a.name) < std::tie(a.is_folder, b.name);
  });
  return entries;
}

ReadableFile Roots::open_read(const fs::path& file) const {
  const Place place = place_of(file);
  const fs::path path = folders_[place.root] / place.below;
  Handle folder = open_folder({place.root, place.below.has_parent_path() ? place.below.parent_path() : "."});
  // Without O_NONBLOCK a pipe would keep us waiting for somebody to write into it.
  Handle handle(
      openat(folder.number(), place.below.filename().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!handle.valid()) refuse(ErrorCode::invalid_input, path, reason_of(errno));
  struct stat about = {};
  if (fstat(handle.number(), &about) != 0 || !S_ISREG(about.st_mode))
    refuse(ErrorCode::invalid_input, path, "is no plain file");
  return {path, std::move(folder), std::move(handle)};
}

WritableFile Roots::prepare_write(const fs::path& folder, const std::string& name, bool overwrite) const {
  if (!is_name(name)) refuse(ErrorCode::output_not_written, name, "is no name for a file");
  try {
    const Place place = place_of(folder);
    const fs::path path = (folders_[place.root] / place.below).lexically_normal() / name;
    Handle held = open_folder(place);
    struct stat about = {};
    const bool there = fstatat(held.number(), name.c_str(), &about, AT_SYMLINK_NOFOLLOW) == 0;
    if (there && !S_ISREG(about.st_mode)) refuse(ErrorCode::output_not_written, path, "is there and no plain file");
    if (there && !overwrite) refuse(ErrorCode::output_not_written, path, "is there already");
    if (there && faccessat(held.number(), name.c_str(), W_OK, AT_EACCESS) != 0)
      refuse(ErrorCode::output_not_written, path, "is write-protected");
    return {path, std::move(held), there ? static_cast<int>(about.st_mode & 0777) : -1};
  } catch (const Error& error) {
    throw Error(ErrorCode::output_not_written, error.what());
  }
}

}  // namespace pointskin::studio
