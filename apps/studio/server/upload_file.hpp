// A file that grows while it is uploaded, and is gone again unless it came whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace pointskin::studio::server {

class UploadFile {
 public:
  /// Makes a file in `folder` that only this user can read. Its name is random, with the extension of `name`.
  /// @throws Error output_not_written
  UploadFile(const std::filesystem::path& folder, std::string_view name);
  ~UploadFile();
  UploadFile(const UploadFile&) = delete;
  UploadFile& operator=(const UploadFile&) = delete;

  /// @throws Error output_not_written, for example when the disk is full
  void write(std::span<const char> bytes);
  [[nodiscard]] std::int64_t size() const { return size_; }
  /// Closes the file, which stays. @throws Error output_not_written
  std::filesystem::path finish();

 private:
  std::filesystem::path path_;  ///< empty: it is no longer ours
  int file_ = -1;
  std::int64_t size_ = 0;
};

}  // namespace pointskin::studio::server
