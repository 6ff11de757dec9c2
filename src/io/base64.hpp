// Base64 (RFC 4648).
#pragma once

#include <string>
#include <string_view>

namespace pointskin::io {

/// The bytes of `text`. Padding, blanks and line ends are passed over, as is whatever else is no digit.
std::string from_base64(std::string_view text);

/// Characters, with padding, that so many bytes take.
constexpr std::size_t base64_length(std::size_t bytes) { return (bytes + 2) / 3 * 4; }

}  // namespace pointskin::io
