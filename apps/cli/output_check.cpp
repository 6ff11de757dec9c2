#include "output_check.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

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

void check_extension(const std::string& path, std::span<const FormatInfo> formats) {
  if (is_special_file(path) && extension_of(path).empty()) return;  // Gets the first format.
  const FormatInfo* const format = format_of(path, formats);
  if (format != nullptr && format->writes_meshes) return;
  throw_usage(fmt::format("{}: unknown output format; use {}, or - for {} on stdout", path,
                          extension_list(&FormatInfo::writes_meshes, formats), formats.front().name));
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

void check_cloud_name(const std::string& path, const char* story, const std::string& named) {
  const FormatInfo* const format = format_of(path);
  if (path == "-" || (format != nullptr && format->writes_clouds)) return;
  const std::string extensions = extension_list(&FormatInfo::writes_clouds);
  throw_usage(fmt::format(fmt::runtime(story), named.empty() ? path : named, extensions));
}

void check_result(const std::string& path) {
  if (path != "-") return check_replaceable(path);
  if (!stdout_is_open()) throw Error(ErrorCode::output_not_written, "stdout: cannot be written: it is closed");
  if (isatty(STDOUT_FILENO) == 1)
    throw_usage("stdout is a terminal, and PLY is binary; redirect it or name a file with -o");
}

void check_mesh_output(const std::string& path, std::span<const FormatInfo> formats) {
  if (path != "-") check_extension(path, formats);
  check_result(path);
}

}  // namespace pointskin::cli
