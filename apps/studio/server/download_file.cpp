#include "studio/server/download_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace pointskin::studio::server {

DownloadFile::DownloadFile(int file, std::string name) : file_(file), name_(std::move(name)) {
  struct stat about = {};
  if (file_ >= 0 && fstat(file_, &about) == 0 && S_ISREG(about.st_mode)) size_ = about.st_size;
}

DownloadFile::~DownloadFile() {
  if (file_ >= 0) close(file_);
}

std::shared_ptr<DownloadFile> DownloadFile::open(const Download& download) {
  // Without O_NONBLOCK a pipe would keep us waiting for somebody to write into it.
  const int number = ::open(download.file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  std::shared_ptr<DownloadFile> file(new DownloadFile(number, download.name));
  if (download.temporary) unlink(download.file.c_str());
  return file->size_ < 0 ? nullptr : file;
}

std::size_t DownloadFile::read(std::span<std::byte> block) {
  for (;;) {
    const ssize_t count = ::read(file_, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    return count > 0 ? static_cast<std::size_t>(count) : 0;
  }
}

}  // namespace pointskin::studio::server
