// Fuzzes every cloud reader. The first byte picks the format, the rest is the file.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>

#include <pointskin/error.hpp>

#include "io/readers.hpp"

using namespace pointskin;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr io::Format kFormats[] = {io::Format::ply, io::Format::text, io::Format::obj, io::Format::stl,
                                     io::Format::off, io::Format::vtk,  io::Format::json};
  const io::Format format = kFormats[data[0] % std::size(kFormats)];
  ReadOptions options;
  options.threads = 1;
  try {
    const Cloud cloud = io::parse_cloud({"fuzz", {reinterpret_cast<const char*>(data + 1), size - 1}}, format, options);
    if (!cloud.normals.empty() && cloud.normals.size() != cloud.positions.size()) std::abort();
    for (const Attribute& a : cloud.attributes)
      if (a.values.size() != cloud.positions.size()) std::abort();
    for (const Vec3f& p : cloud.positions)
      if (!(p.x - p.x == 0 && p.y - p.y == 0 && p.z - p.z == 0)) std::abort();  // not finite
  } catch (const Error&) {
    // An answer like any other; everything else ends the fuzzer.
  }
  return 0;
}
