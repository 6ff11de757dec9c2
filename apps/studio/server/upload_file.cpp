#include "studio/server/upload_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

#include <pointskin/error.hpp>

namespace pointskin::studio::server {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw Error(ErrorCode::output_not_written, path.string() + ": " + std::strerror(errno));
}

/// Readers tell formats by it. Empty unless it is short and plain.
std::string extension_of(std::string_view name) {
  constexpr std::size_t kMost = 9;
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || name.size() - dot > kMost) return "";
  const std::string extension(name.substr(dot));
  const auto is_plain = [](unsigned char c) { return std::isalnum(c) != 0; };
  return std::all_of(extension.begin() + 1, extension.end(), is_plain) ? extension : "";
}

}  // namespace

UploadFile::UploadFile(const std::filesystem::path& folder, std::string_view name) {
  const std::string extension = extension_of(name);
  std::string form = (folder / "upload-XXXXXX").string() + extension;
  file_ = mkostemps(form.data(), static_cast<int>(extension.size()), O_CLOEXEC);
  if (file_ < 0) fail(form);
  path_ = form;
}

UploadFile::~UploadFile() {
  if (file_ >= 0) close(file_);
  if (!path_.empty()) unlink(path_.c_str());
}

void UploadFile::write(std::span<const char> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path_);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    size_ += written;
  }
}

std::filesystem::path UploadFile::finish() {
  const int file = std::exchange(file_, -1);
  if (close(file) != 0) fail(path_);
  return std::exchange(path_, {});
}

}  // namespace pointskin::studio::server
