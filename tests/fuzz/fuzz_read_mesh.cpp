// Fuzzes every mesh reader. The first byte picks the format, the rest is the file.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <pointskin/error.hpp>

#include "io/formats.hpp"

using namespace pointskin;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const io::Formats format = io::formats().subspan(data[0] % io::formats().size(), 1);
  if (!format.front().info.reads_meshes) return 0;
  const std::string name = "fuzz" + format.front().info.extensions.front();
  ReadOptions options;
  options.threads = 1;
  try {
    const Mesh mesh = io::parse_mesh({name, {reinterpret_cast<const char*>(data + 1), size - 1}}, options, format);
    const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
    for (const Triangle& triangle : mesh.triangles)
      for (const std::int32_t corner : triangle)
        if (corner < 0 || corner >= vertices) std::abort();
  } catch (const Error&) {
    // An answer like any other; everything else ends the fuzzer.
  }
  return 0;
}
