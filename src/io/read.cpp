#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <new>
#include <stdexcept>

#include "io/file_descriptor.hpp"
#include "io/formats.hpp"
#include "io/input.hpp"

namespace pointskin {
namespace {

/// Runs `read` on the file's bytes; memory that runs out becomes an Error like any other.
template <class Read>
auto read_file(const std::string& path, const Read& read) {
  try {
    const io::Input input(path);
    return read(input.source());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::over_limit, "out of memory; while reading " + io::printable(path));
  } catch (const std::length_error&) {
    throw Error(ErrorCode::over_limit, "out of memory; while reading " + io::printable(path));
  }
}

std::string start_of(int file) {
  constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 16;
  std::string start(kMostHeaderBytes, '\0');
  const ssize_t count = ::pread(file, start.data(), start.size(), 0);
  start.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return start;
}

}  // namespace

Cloud read_cloud(const std::string& path, const ReadOptions& options) {
  return read_file(path, [&](const io::Source& source) { return io::parse_cloud(source, options); });
}

Mesh read_mesh(const std::string& path, const ReadOptions& options) {
  return read_file(path, [&](const io::Source& source) { return io::parse_mesh(source, options); });
}

bool may_hold_faces(const std::string& path) {
  if (path == "-") return io::may_hold_faces(path, start_of(STDIN_FILENO));
  const io::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // no waiting for pipes
  return io::may_hold_faces(path, file.valid() ? start_of(file.get()) : "");
}

}  // namespace pointskin
