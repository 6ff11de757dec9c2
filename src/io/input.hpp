// The bytes of an input: a mapped file, or memory where a file cannot be mapped.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "io/file_descriptor.hpp"
#include "io/mapped_file.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// @throws Error invalid_input with the system's words for `error`, an errno
[[noreturn]] void fail_to_read(const std::string& name, int error);

/// Opens `path` ("-": stdin) and holds its bytes. Regular files are mapped read-only, stdin too if it is one from its
/// beginning; pipes and devices are read to their end.
class Input {
 public:
  /// @throws Error invalid_input if `path` is missing, a directory, unreadable or empty
  explicit Input(const std::string& path);
  ~Input() = default;
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  [[nodiscard]] Source source() const;

  /// Copies bytes of the file without looking at its mapping, whose pages would stay in memory. For many threads at once.
  /// @throws Error invalid_input if they are not there any more, or cannot be read
  void read_at(std::size_t at, std::size_t bytes, char* out) const;

  /// Gives back the memory of bytes of the source that are not needed for a while.
  void release(std::string_view some) const noexcept {
    if (mapping_.mapped()) mapping_.release(some);
  }

  /// To be called when the bytes have been used: a mapped file may have lost some since, which then read as zeros.
  /// @throws Error invalid_input if it did
  void check_whole() const;

 private:
  void read_all(int fd);
  [[noreturn]] void fail_as_cut() const;

  std::string name_;
  std::string memory_;
  FileDescriptor file_;
  MappedFile mapping_;
};

}  // namespace pointskin::io
