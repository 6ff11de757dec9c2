// A .npy file: points in the rows of an array.
#include "io/numpy_table.hpp"
#include "io/readers.hpp"

namespace pointskin::io {

Cloud parse_npy_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const NpyArray array = parse_npy(source);
  return assemble(ex, source, table_of(source, array).table(), options.shift);
}

}  // namespace pointskin::io
