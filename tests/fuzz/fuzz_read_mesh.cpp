// Fuzzes every mesh reader. The first byte picks the format, the rest is the file.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>

#include <pointskin/error.hpp>

#include "io/readers.hpp"

using namespace pointskin;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr io::Format kFormats[] = {io::Format::ply, io::Format::obj, io::Format::stl, io::Format::off};
  const io::Format format = kFormats[data[0] % std::size(kFormats)];
  ReadOptions options;
  options.threads = 1;
  try {
    const Mesh mesh = io::parse_mesh({"fuzz", {reinterpret_cast<const char*>(data + 1), size - 1}}, format, options);
    const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
    for (const Triangle& triangle : mesh.triangles)
      for (const std::int32_t corner : triangle)
        if (corner < 0 || corner >= vertices) std::abort();
  } catch (const Error&) {
    // An answer like any other; everything else ends the fuzzer.
  }
  return 0;
}
