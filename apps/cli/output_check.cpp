#include "output_check.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "standard_files.hpp"

namespace pointskin::cli {
namespace {

/// What write_mesh of the library knows.
constexpr std::array kMeshExtensions = {".ply", ".obj", ".stl"};

/// Creates a file in `folder` that never gets a name, or, where the file system cannot, one that is removed at once.
/// Asking for permissions would not do: root has them all, and a read-only file system takes them back.
/// @returns 0 or errno
int try_new_file(const std::string& folder) {
  const int unnamed = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (unnamed >= 0) return close(unnamed), 0;
  if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL) return errno;
  std::string named = folder + "/.pointskin-XXXXXX";
  const int file = mkstemp(named.data());
  if (file < 0) return errno;
  close(file);
  unlink(named.c_str());
  return 0;
}

[[noreturn]] void throw_not_writable(const std::string& path, const std::string& reason) {
  throw Error(ErrorCode::output_not_written, fmt::format("{}: cannot be written: {}", path, reason));
}

bool is_special_file(const std::string& path) {
  struct stat status = {};
  return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

void check_extension(const std::string& path) {
  if (is_special_file(path) && std::filesystem::path(path).extension().empty()) return;  // Gets PLY.
  const bool known = std::any_of(kMeshExtensions.begin(), kMeshExtensions.end(),
                                 [&](const char* extension) { return has_extension(path, extension); });
  if (known) return;
  throw_usage(fmt::format("{}: unknown output format; use .ply, .obj or .stl, or - for PLY on stdout", path));
}

}  // namespace

void check_replaceable(const std::string& path) {
  if (is_special_file(path)) return;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw_not_writable(path, "it is a folder");
  const bool exists = access(path.c_str(), F_OK) == 0;  // Write-protected files are not replaced.
  if (exists && faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) {
    throw_not_writable(path, std::strerror(errno));
  }
  std::filesystem::path target =
      std::filesystem::weakly_canonical(path, ignored);  // A link's target is what is replaced.
  if (target.empty()) target = path;
  const std::string folder = target.has_parent_path() ? target.parent_path().string() : ".";
  if (const int error = try_new_file(folder); error != 0) {
    throw_not_writable(path, fmt::format("folder {}: {}", folder, std::strerror(error)));
  }
}

void check_mesh_output(const std::string& path) {
  if (path != "-") {
    check_extension(path);
    return check_replaceable(path);
  }
  if (!stdout_is_open()) throw Error(ErrorCode::output_not_written, "stdout: cannot be written: it is closed");
  if (isatty(STDOUT_FILENO) == 1) {
    throw_usage("stdout is a terminal, and PLY is binary; redirect it or name a file with -o");
  }
}

}  // namespace pointskin::cli
