// A file's bytes in memory without reading them, safe against a file that is cut or fails meanwhile.
#pragma once

#include <cstddef>
#include <string_view>

namespace pointskin::io {

/// Maps a file read-only. Bytes that cannot be had when they are looked at, because another program has cut the file or
/// the disk fails, would end the process with SIGBUS; while one of these lives, they read as zeros instead, and
/// lost_bytes() tells. Faults elsewhere go to the handler that was there before. Different threads may have different
/// ones, at most 64 at a time in a process.
class MappedFile {
 public:
  MappedFile() = default;
  ~MappedFile() { unmap(); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// @param size  above 0 @returns false if the file system cannot map it, or too many are mapped
  bool map(int fd, std::size_t size);

  [[nodiscard]] bool mapped() const noexcept { return begin_ != nullptr; }
  [[nodiscard]] std::string_view bytes() const noexcept { return {begin_, size_}; }
  [[nodiscard]] bool lost_bytes() const noexcept;

  /// Gives back the memory in which bytes of the file lie; they are read again when they are looked at.
  void release(std::string_view some) const noexcept;

 private:
  void unmap() noexcept;

  const char* begin_ = nullptr;
  std::size_t size_ = 0;
  int slot_ = -1;
};

}  // namespace pointskin::io
