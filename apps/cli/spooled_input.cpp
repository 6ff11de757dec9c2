#include "spooled_input.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>

namespace pointskin::cli {
namespace {

[[noreturn]] void fail_in(const std::string& folder, const char* what) {
  throw Error(ErrorCode::output_not_written, fmt::format("{}: {}, {}; choose another folder with --temp", folder, what,
                                                         std::generic_category().message(errno)));
}

[[noreturn]] void fail_to_read_pipe(const std::string& path) {
  throw Error(ErrorCode::invalid_input,
              fmt::format("{}: cannot be read, {}; check the program that writes it", path == "-" ? "stdin" : path,
                          std::generic_category().message(errno)));
}

int make_nameless_file(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_EXCL | O_CLOEXEC, 0600);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return file;
  std::string name = folder + "/.pointskin_XXXXXX";  // the file system has no files without names
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

/// @returns false at the end
bool read_some(int pipe, std::vector<char>& bytes, const std::string& path) {
  bytes.resize(bytes.capacity());
  for (;;) {
    const ssize_t got = ::read(pipe, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_to_read_pipe(path);
    bytes.resize(static_cast<std::size_t>(got));
    return got > 0;
  }
}

void write_all(int file, const std::vector<char>& bytes, const std::string& folder) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t now = ::write(file, bytes.data() + done, bytes.size() - done);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) fail_in(folder, "the input does not fit");
    done += static_cast<std::size_t>(now);
  }
}

std::string system_folder() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  return error ? "/tmp" : folder.string();
}

}  // namespace

bool is_pipe(const std::string& path) {
  struct stat status {};
  const int failed = path == "-" ? ::fstat(STDIN_FILENO, &status) : ::stat(path.c_str(), &status);
  return failed == 0 && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode));
}

std::string spool_pipe(const std::string& path, const std::string& folder) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 20;
  const std::string where = folder.empty() ? system_folder() : folder;
  const int file = make_nameless_file(where);
  if (file < 0) fail_in(where, "no temporary file can be made");
  const int pipe = path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (pipe < 0) fail_to_read_pipe(path);
  std::vector<char> bytes;
  bytes.reserve(kAtOnce);
  while (read_some(pipe, bytes, path)) write_all(file, bytes, where);
  if (pipe != STDIN_FILENO) ::close(pipe);
  ::lseek(file, 0, SEEK_SET);
  if (path != "-") return fmt::format("/dev/fd/{}", file);
  if (::dup2(file, STDIN_FILENO) < 0) fail_in(where, "the temporary file cannot be read");
  ::close(file);
  return path;
}

}  // namespace pointskin::cli
