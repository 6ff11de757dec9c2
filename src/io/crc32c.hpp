// CRC-32C, the checksum of iSCSI and of E57.
#pragma once

#include <cstdint>
#include <string_view>

namespace pointskin::io {

/// CRC-32C of `bytes`: the polynomial 0x1EDC6F41, reflected, with ones before and after. Source: RFC 3720, appendix B.
std::uint32_t crc32c(std::string_view bytes);

}  // namespace pointskin::io
