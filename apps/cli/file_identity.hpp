// Which file a name stands for, whatever dots and links lead there.
#pragma once

#include <sys/types.h>

#include <compare>
#include <string>

namespace pointskin::cli {

/// Two names stand for one file exactly if their identities are equal.
struct FileIdentity {
  enum class Kind {
    missing,  ///< a name in a folder where there is no such file yet
    regular,  ///< also folders
    pipe,     ///< also sockets and disks: what is written twice is mixed up
    device,   ///< character devices, such as /dev/null and terminals: may be named as often as one likes
  };
  Kind kind = Kind::missing;
  dev_t device = 0;  ///< of the file, or of the folder
  ino_t inode = 0;   ///< of the file, or of the folder
  std::string name;  ///< in the folder, if there is no such file; the whole path if there is no such folder either

  auto operator<=>(const FileIdentity&) const = default;
};

/// The file that writing to, or reading from, `path` would reach: symbolic links are followed, also those that lead
/// nowhere yet.
FileIdentity identify(const std::string& path);

/// The same of an open descriptor, such as stdin.
FileIdentity identify_descriptor(int descriptor);

}  // namespace pointskin::cli
