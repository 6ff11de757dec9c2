// Files that appear whole or not at all.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "exec/cpu.hpp"

namespace pointskin::io {

/// What a file is to hold, cut into blocks of about 256 KiB that can be made in any order.
struct Blocks {
  std::int64_t count = 0;
  /// Appends the bytes of block `b` to `bytes`; called once per block, on any thread.
  std::function<void(std::int64_t b, std::string& bytes)> make;
  /// The bytes before block `b`, 0 to count, where they are known before any block is made; else empty.
  std::function<std::int64_t(std::int64_t b)> place{};
};

/// True if `path` is "-" or names something that exists and is neither a regular file nor a folder.
bool is_stream(const std::string& path);

/// Replaces the file `path` by the blocks, one after the other, by a rename from a temporary file in the same folder.
/// Streams are written directly, "-" is stdout. Blocks are made, and those of files written, in parallel; only as many
/// as there are threads are in memory at a time.
/// @throws Error output_not_written with the reason of the operating system, or whatever `make` throws; a regular file
///         is then what it was
void write_blocks(exec::Cpu& ex, const std::string& path, const Blocks& blocks);

class TemporaryFile;

/// Several files that appear together: all are written under temporary names before the first one gets its own.
class FilesTogether {
 public:
  FilesTogether();
  ~FilesTogether();  ///< removes what has not been given its name
  FilesTogether(const FilesTogether&) = delete;
  FilesTogether& operator=(const FilesTogether&) = delete;

  /// As write_blocks(), but that the file `path` stays what it was until replace(). Streams are written at once.
  void write(exec::Cpu& ex, const std::string& path, const Blocks& blocks);

  /// Gives all files their names. Nothing but a rename can fail here; the files after that one stay what they were.
  /// @throws Error output_not_written
  void replace();

 private:
  std::vector<std::unique_ptr<TemporaryFile>> files_;
};

/// A file that several processes write, each a part of it, and that appears whole or not at all, too. One makes it, the others open
/// it by its temporary name; when all have finished, the one that made it gives it its own.
class FileOfMany {
 public:
  /// @param path  of a regular file, or of nothing yet
  /// @throws Error output_not_written with the reason of the operating system
  static FileOfMany make(const std::string& path);
  static FileOfMany open(const std::string& path, const std::string& temporary_name);
  FileOfMany(FileOfMany&&) noexcept;
  ~FileOfMany();  ///< removes the file, whoever made it, unless it has its name

  [[nodiscard]] const std::string& temporary_name() const;

  /// Blocks first..last - 1 of all, whose places are known.
  /// @throws Error as write_blocks()
  void write(exec::Cpu& ex, const Blocks& blocks, std::int64_t first, std::int64_t last);

  /// All that this process has written is on the disk then. Nothing can be written after that.
  /// @throws Error output_not_written
  void finish();

  /// Of the process that has made the file, after finish() of all. @throws Error output_not_written
  void replace();
  /// Of the others, after that.
  void forget();

 private:
  explicit FileOfMany(std::unique_ptr<TemporaryFile> file);
  std::unique_ptr<TemporaryFile> file_;
};

}  // namespace pointskin::io
