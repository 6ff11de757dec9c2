// Files below a few folders, and no others: what a page may read and write. Knows no transport.
//
// Names are looked up by openat2 with RESOLVE_BENEATH and RESOLVE_NO_SYMLINKS (Linux 5.6), or part by part with
// O_NOFOLLOW where the kernel has no openat2 or forbids it. A folder that was looked up is held open, and files in it are
// reached through that: exchanging a folder above for a link, between a check and its use, leads nowhere.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pointskin::studio {

/// An open file or folder, closed at the end of its life.
class Handle {
 public:
  explicit Handle(int number = -1) : number_(number) {}
  ~Handle();
  Handle(Handle&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  [[nodiscard]] bool valid() const { return number_ >= 0; }
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

/// What is in a folder.
struct FolderEntry {
  std::string name;
  bool is_folder = false;
  std::int64_t bytes = 0;  ///< of a file
};

/// A file below a root, open for reading.
class ReadableFile {
 public:
  ReadableFile(std::filesystem::path path, Handle folder, Handle file)
      : path_(std::move(path)), folder_(std::move(folder)), file_(std::move(file)) {}

  /// For people and documents: absolute, by the name of the root.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Of the file itself, at its start.
  [[nodiscard]] int number() const { return file_.number(); }

  /// A path for the library's readers, which tell formats by the extension; valid while this lives. It leads through the
  /// folder that is held open, so that only the last part could still be exchanged: see check_unchanged().
  [[nodiscard]] std::string pinned_path() const;

  /// To be called after reading by the path. @throws Error invalid_input if the name no longer means the file that was
  /// looked up: what was read may lie elsewhere and must not be used
  void check_unchanged() const;

  /// `story` with the path for people in place of pinned_path().
  [[nodiscard]] std::string readable(std::string story) const;

 private:
  std::filesystem::path path_;
  Handle folder_, file_;
};

/// A file that is to appear below a root, whole or not at all.
class WritableFile {
 public:
  /// Makes a folder of its own in `folder`, which nobody else can reach into.
  /// @param mode  permissions of the file that it takes the place of; -1: there was none, and must be none
  /// @throws Error output_not_written
  WritableFile(std::filesystem::path path, Handle folder, int mode);
  ~WritableFile();
  WritableFile(WritableFile&&) noexcept = default;
  WritableFile& operator=(WritableFile&&) = delete;
  WritableFile(const WritableFile&) = delete;
  WritableFile& operator=(const WritableFile&) = delete;

  /// Where the file will be.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Where to write it, by whichever function; has the name of path(). What is there without commit() is removed.
  [[nodiscard]] std::string pinned_path() const;
  /// Gives it its name, in one step. A link of that name is replaced and not followed. @returns its size in bytes
  /// @throws Error output_not_written, also if the name is taken meanwhile and must not be overwritten
  std::int64_t commit();

  /// `story` with the path for people in place of pinned_path().
  [[nodiscard]] std::string readable(std::string story) const;

 private:
  std::filesystem::path path_;
  Handle folder_, own_;
  std::string own_name_{};  ///< of the folder of its own, in `folder_`
  int mode_;
};

/// How names are looked up.
enum class Lookup {
  automatic,  ///< by openat2, or part by part where there is none
  by_parts,   ///< for tests
};

/// Paths are absolute or relative to the first root. All functions may be called from any thread.
class Roots {
 public:
  /// @param folders  at least one, each open from now on
  /// @throws Error usage if one is no folder that can be read
  explicit Roots(const std::vector<std::filesystem::path>& folders, Lookup lookup = Lookup::automatic);

  /// Absolute and without links.
  [[nodiscard]] const std::vector<std::filesystem::path>& folders() const { return folders_; }

  /// Folders first, then by name; at most 10,000. Links, what is neither a file nor a folder, and names that begin with a
  /// dot or are no UTF-8 are left out.
  /// @throws Error invalid_input if `folder` lies outside, leads over a link, or is no folder that can be read
  [[nodiscard]] std::vector<FolderEntry> list(const std::filesystem::path& folder) const;

  /// @throws Error invalid_input if `file` lies outside, leads over a link, or is no plain file that can be read
  [[nodiscard]] ReadableFile open_read(const std::filesystem::path& file) const;

  /// @param name  of the file, without folders
  /// @throws Error output_not_written if `folder` lies outside, leads over a link or cannot be written, if `name` is no
  ///         name for a file, or if there is something of this name that must not be overwritten
  [[nodiscard]] WritableFile prepare_write(const std::filesystem::path& folder, const std::string& name,
                                           bool overwrite) const;

 private:
  /// A path as a root and what is below it; "." is the root itself.
  struct Place {
    std::size_t root;
    std::filesystem::path below;
  };
  [[nodiscard]] Place place_of(const std::filesystem::path& path) const;
  [[nodiscard]] Handle open_below(const Place& place, int flags) const;
  [[nodiscard]] Handle open_folder(const Place& place) const;

  std::vector<std::filesystem::path> folders_;
  std::vector<Handle> handles_;  ///< of the folders
  Lookup lookup_;
};

}  // namespace pointskin::studio
