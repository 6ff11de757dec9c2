#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <new>
#include <stdexcept>

#include "io/input.hpp"
#include "io/readers.hpp"

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

}  // namespace

Cloud read_cloud(const std::string& path, const ReadOptions& options) {
  return read_file(path, [&](const io::Source& source) {
    return io::parse_cloud(source, io::detect_format(source, false), options);
  });
}

Mesh read_mesh(const std::string& path, const ReadOptions& options) {
  return read_file(
      path, [&](const io::Source& source) { return io::parse_mesh(source, io::detect_format(source, true), options); });
}

}  // namespace pointskin
