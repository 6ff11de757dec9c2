#include "io/inflate.hpp"

#include <zlib.h>

namespace pointskin::io {

bool inflate_to(std::string_view packed, std::size_t bytes, std::string& out) {
  const std::size_t before = out.size();
  out.resize(before + bytes);
  uLongf length = bytes;
  const int state = uncompress(reinterpret_cast<Bytef*>(out.data() + before), &length,
                               reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  return state == Z_OK && length == bytes;
}

}  // namespace pointskin::io
