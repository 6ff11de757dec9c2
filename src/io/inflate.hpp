// Bytes that zlib has made smaller. Where it is built in (kHasZlib), by zlib.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pointskin::io {

/// The most that deflate shrinks (zlib's technical details).
inline constexpr std::size_t kMostDeflated = 1032;

/// Unpacks a stream of zlib (RFC 1950) behind `out`. @returns false if it is broken, or not exactly `bytes` long
bool inflate_to(std::string_view packed, std::size_t bytes, std::string& out);

}  // namespace pointskin::io
