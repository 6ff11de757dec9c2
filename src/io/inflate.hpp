// Bytes that zlib has made smaller. Where it is built in (kHasZlib), by zlib.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace pointskin::io {

/// The most that deflate shrinks (zlib's technical details).
inline constexpr std::size_t kMostDeflated = 1032;

/// Unpacks a stream of zlib (RFC 1950) behind `out`. @returns false if it is broken, or not exactly `bytes` long
bool inflate_to(std::string_view packed, std::size_t bytes, std::string& out);

/// True if a file of gzip begins so (RFC 1952).
inline bool is_gzip(std::string_view start) { return start.starts_with("\x1f\x8b"); }

/// Unpacks a file of gzip. @returns nothing if it is broken or ends early
std::optional<std::string> gunzip(std::string_view packed);

}  // namespace pointskin::io
