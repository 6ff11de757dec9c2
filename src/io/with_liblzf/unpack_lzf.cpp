#include <limits>

#include <liblzf/lzf.h>

#include "io/lzf.hpp"

namespace pointskin::io {

std::string unpack_lzf(std::string_view packed, std::size_t bytes) {
  constexpr std::size_t kMost = std::numeric_limits<unsigned>::max();
  if (packed.size() > kMost || bytes > kMost) return {};
  std::string out(bytes, '\0');
  const unsigned done =
      lzf_decompress(packed.data(), static_cast<unsigned>(packed.size()), out.data(), static_cast<unsigned>(bytes));
  return done == bytes ? out : std::string();
}

}  // namespace pointskin::io
