// Fuzzes every cloud reader. The first byte picks the format, the rest is the file.
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
  const std::string name = "fuzz" + format.front().info.extensions.front();
  ReadOptions options;
  options.threads = 1;
  try {
    const Cloud cloud = io::parse_cloud({name, {reinterpret_cast<const char*>(data + 1), size - 1}}, options, format);
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
