// A file that is sent to a page: opened once, so that what is sent is what was checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "studio/session/application.hpp"

namespace pointskin::studio::server {

class DownloadFile {
 public:
  /// A temporary file loses its name at once; its bytes stay while this lives.
  /// @returns null if there is no such file, or if it is a link or no plain file
  static std::shared_ptr<DownloadFile> open(const Download& download);
  ~DownloadFile();
  DownloadFile(const DownloadFile&) = delete;
  DownloadFile& operator=(const DownloadFile&) = delete;

  /// The next bytes. @returns how many; 0 at the end of the file and if it cannot be read
  std::size_t read(std::span<std::byte> block);
  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  DownloadFile(int file, std::string name);

  int file_;
  std::int64_t size_ = -1;  ///< below 0: no plain file
  std::string name_;
};

}  // namespace pointskin::studio::server
