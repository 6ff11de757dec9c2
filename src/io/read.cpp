#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <stdexcept>

#include "io/file_descriptor.hpp"
#include "io/formats.hpp"
#include "io/input.hpp"

namespace pointskin {
namespace {

/// What was cut off while it was read looks like a mistake in the file, or like none: that it was cut is what is told.
template <class Read>
auto use(const io::Input& input, const Read& read) {
  try {
    auto content = read(input.source());
    input.check_whole();
    return content;
  } catch (const Error&) {
    input.check_whole();
    throw;
  }
}

/// Runs `read` on the file's bytes; memory that runs out becomes an Error like any other.
template <class Read>
auto read_file(const std::string& path, const Read& read) {
  try {
    const io::Input input(path);
    return use(input, read);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::over_limit, "out of memory; while reading " + io::printable(path));
  } catch (const std::length_error&) {
    throw Error(ErrorCode::over_limit, "out of memory; while reading " + io::printable(path));
  }
}

/// The first bytes of what can be read twice. Pipes cannot, and have none here; of folders the readers tell.
std::string start_of(const std::string& path, int file) {
  constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 16;
  std::string start(kMostHeaderBytes, '\0');
  std::size_t used = 0;
  while (used < start.size()) {
    const ssize_t count = ::pread(file, start.data() + used, start.size() - used, static_cast<off_t>(used));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno != ESPIPE && errno != EISDIR && errno != EBADF) io::fail_to_read(path, errno);
    if (count <= 0) break;
    used += static_cast<std::size_t>(count);
  }
  start.resize(used);
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
  if (path == "-") return io::may_hold_faces(path, start_of("stdin", STDIN_FILENO));
  const io::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // no waiting for pipes
  if (!file.valid()) io::fail_to_read(path, errno);
  return io::may_hold_faces(path, start_of(path, file.get()));
}

}  // namespace pointskin
