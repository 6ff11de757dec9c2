// Zip archives in memory. Where they are built in (kHasMinizip), minizip reads them and zlib deflates what is written.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/source.hpp"

namespace pointskin::io {

/// A file in an archive.
struct ZipEntry {
  std::string name;
  std::uint64_t bytes = 0;          ///< as it is read
  std::string_view stored;          ///< where it lies as it is; empty if it is compressed
  std::uint64_t place[2] = {0, 0};  ///< for minizip
};

/// The files of the archive, in the order of its directory. Their lengths are possible for the archive's, also taken
/// together, so that a small file does not become a large one.
/// @throws Error invalid_input for a broken archive, or encrypted files
std::vector<ZipEntry> zip_entries(const Source& source);

/// The bytes of a file. Source and entry must belong together. @throws Error invalid_input for a wrong checksum
std::string unzip(const Source& source, const ZipEntry& entry);

/// A file to put into an archive.
struct ZipFile {
  std::string name;
  std::string bytes;
};

/// An archive of `files`; the same bytes at any time. @param deflated  compressed; else as they are
/// @throws Error over_limit for a name of more than 65,535 bytes; std::bad_alloc
std::string zip(const std::vector<ZipFile>& files, bool deflated);

}  // namespace pointskin::io
