#include "file_identity.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <system_error>

namespace pointskin::cli {
namespace {

FileIdentity identity_of(const struct stat& status) {
  FileIdentity::Kind kind = FileIdentity::Kind::pipe;
  if (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) kind = FileIdentity::Kind::regular;
  if (S_ISCHR(status.st_mode)) kind = FileIdentity::Kind::device;
  return {kind, status.st_dev, status.st_ino, ""};
}

/// Where a link that leads nowhere would have a file made; `path` itself if it is no link.
std::filesystem::path follow_links(std::filesystem::path path) {
  constexpr int kMostLinks = 40;
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code none;
    const std::filesystem::path target = std::filesystem::read_symlink(path, none);
    if (none) break;
    path = path.parent_path() / target;  // stays what it was for a target from the root
  }
  return path;
}

}  // namespace

FileIdentity identify(const std::string& path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) == 0) return identity_of(status);
  const std::filesystem::path target = follow_links(path);
  const std::string folder = target.has_parent_path() ? target.parent_path().string() : ".";
  if (stat(folder.c_str(), &status) == 0)
    return {FileIdentity::Kind::missing, status.st_dev, status.st_ino, target.filename().string()};
  std::error_code ignored;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(target, ignored);
  return {FileIdentity::Kind::missing, 0, 0, whole.empty() ? target.string() : whole.string()};
}

FileIdentity identify_descriptor(int descriptor) {
  struct stat status = {};
  if (fstat(descriptor, &status) == 0) return identity_of(status);
  return {FileIdentity::Kind::device, 0, 0, ""};  // closed: compared with nothing
}

}  // namespace pointskin::cli
