// The bytes of an input: a mapped file, or memory where a file cannot be mapped.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "io/source.hpp"

namespace pointskin::io {

/// Opens `path` ("-": stdin) and holds its bytes. Regular files are mapped read-only; pipes, devices and stdin are
/// read to their end. A file that another program shortens meanwhile ends the process with SIGBUS, as with any mapping.
class Input {
 public:
  /// @throws Error invalid_input if `path` is missing, a directory, unreadable or empty
  explicit Input(const std::string& path);
  ~Input();
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  [[nodiscard]] Source source() const;

 private:
  void read_all(int fd);

  std::string name_;
  std::string memory_;
  void* mapping_ = nullptr;
  std::size_t mapped_bytes_ = 0;
};

}  // namespace pointskin::io
