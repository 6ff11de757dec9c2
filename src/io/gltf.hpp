// Numbers that glTF 2.0 files are made of.
#pragma once

#include <cstdint>

namespace pointskin::io {

inline constexpr std::uint32_t kGlbMagic = 0x46546C67;   ///< "glTF"
inline constexpr std::uint32_t kGlbJson = 0x4E4F534A;    ///< "JSON"
inline constexpr std::uint32_t kGlbBinary = 0x004E4942;  ///< "BIN"

/// Types of components, as OpenGL numbers them.
inline constexpr int kGltfInt8 = 5120, kGltfUint8 = 5121, kGltfInt16 = 5122, kGltfUint16 = 5123, kGltfUint32 = 5125,
                     kGltfFloat = 5126;

}  // namespace pointskin::io
