#include "probe.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"

namespace pointskin::cli {
namespace {

constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 16;

std::string read_start(int file) {
  std::string start(kMostHeaderBytes, '\0');
  const ssize_t count = pread(file, start.data(), start.size(), 0);
  start.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return start;
}

std::string read_start(const std::string& path) {
  if (path == "-") return read_start(STDIN_FILENO);
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // A FIFO without a writer must not hang.
  if (file < 0) return {};
  std::string start = read_start(file);
  close(file);
  return start;
}

/// True if the PLY header has a line "element face N" with N > 0.
bool ply_announces_faces(std::string_view header) {
  constexpr std::string_view kFace = "\nelement face ";
  header = header.substr(0, header.find("end_header"));
  const std::size_t at = header.find(kFace);
  return at != std::string_view::npos && header.substr(at + kFace.size()).find_first_not_of(" 0\r\n") == 0;
}

void write_all(int file, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = write(file, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw Error(ErrorCode::over_limit, "stdin does not fit into memory");
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

void copy_stdin_to(int file) {
  std::vector<char> block(std::size_t{1} << 20);
  for (;;) {
    const ssize_t count = read(STDIN_FILENO, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw Error(ErrorCode::invalid_input, fmt::format("stdin: {}", std::strerror(errno)));
    if (count == 0) return;
    write_all(file, block.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

void make_stdin_seekable() {
  if (lseek(STDIN_FILENO, 0, SEEK_CUR) >= 0 || errno != ESPIPE) return;
  const int memory = memfd_create("pointskin-stdin", MFD_CLOEXEC);
  if (memory < 0) throw Error(ErrorCode::over_limit, fmt::format("stdin: {}", std::strerror(errno)));
  copy_stdin_to(memory);
  lseek(memory, 0, SEEK_SET);
  dup2(memory, STDIN_FILENO);
  close(memory);
}

bool may_hold_faces(const std::string& path) {
  const std::string start = read_start(path);
  if (start.starts_with("ply")) return ply_announces_faces(start);
  return has_extension(path, ".obj") || has_extension(path, ".stl") || has_extension(path, ".off");
}

}  // namespace pointskin::cli
