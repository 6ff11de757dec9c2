// A mesh as a page decodes it: places, normals and triangles, ready to be drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pointskin::bench {

struct DrawnMesh {
  std::vector<std::uint16_t> positions;  ///< shape (n, 4): 16 bits of the box along each axis, and 0
  std::vector<std::uint8_t> normals;     ///< n times the stride of the section, octahedral
  std::vector<std::uint32_t> triangles;  ///< shape (t, 3)
};

/// @param blob  what `/blob/ID` answers, raw or compressed
/// @throws std::runtime_error if it is not what docs/studio.md says
DrawnMesh decode_mesh(const std::vector<std::byte>& blob);

}  // namespace pointskin::bench
