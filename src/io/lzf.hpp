// LZF, the compression of PCD files. Where it is built in (kHasLzf), by liblzf.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pointskin::io {

/// The most that LZF shrinks: a reference of 3 bytes stands for up to 264.
inline constexpr std::size_t kMostLzf = 88;

/// `packed` unpacked; empty if that are not exactly `bytes` bytes.
std::string unpack_lzf(std::string_view packed, std::size_t bytes);

}  // namespace pointskin::io
