#include "surface/case_table.hpp"

#include <pointskin/error.hpp>

#include <optional>
#include <string>
#include <vector>

#include "octree/keys.hpp"
#include "surface/cell_tracer.hpp"

namespace pointskin::surface {
namespace {

/// Edge number of a crossing on an undivided edge: the coordinate along the edge is 2, the others 0 or 4.
int edge_of(int crossing) {
  const int c[3] = {crossing / 25, crossing / 5 % 5, crossing % 5};
  for (int axis = 0; axis < 3; ++axis)
    if (c[axis] == 2) return axis * 4 + c[(axis + 1) % 3] / 4 * 2 + c[(axis + 2) % 3] / 4;
  return -1;
}

/// Bit 2 axis + side for the two faces that an edge lies in.
int faces_of(int edge) {
  const int axis = edge / 4;
  return 1 << (2 * ((axis + 1) % 3) + (edge / 2 & 1)) | 1 << (2 * ((axis + 2) % 3) + (edge & 1));
}

bool share_face(int edge_a, int edge_b) { return (faces_of(edge_a) & faces_of(edge_b)) != 0; }

using Triangles = std::vector<std::array<int, 3>>;

/// Triangulates loop[first..last] over its chord (first, last) with inner diagonals that lie in no face.
std::optional<Triangles> triangulate(const std::vector<int>& loop, std::size_t first, std::size_t last) {
  if (last - first < 2) return Triangles{};
  for (std::size_t apex = first + 1; apex < last; ++apex) {
    if (apex > first + 1 && share_face(loop[first], loop[apex])) continue;
    if (apex + 1 < last && share_face(loop[apex], loop[last])) continue;
    auto left = triangulate(loop, first, apex);
    auto right = triangulate(loop, apex, last);
    if (!left || !right) continue;
    left->insert(left->end(), right->begin(), right->end());
    left->push_back({loop[first], loop[apex], loop[last]});
    return left;
  }
  return std::nullopt;
}

Case make_case(unsigned corners) {
  std::uint32_t inside = 0;
  for (int s = 0; s < 8; ++s)
    if ((corners >> s & 1) != 0)
      inside |= 1U << grid_index(2 * octree::slot_x(s), 2 * octree::slot_y(s), 2 * octree::slot_z(s));
  CellTracer tracer(inside);
  for (int face = 0; face < 6; ++face) tracer.add_face(face / 2, face % 2, false, 0);

  Case result;
  tracer.for_loops([&](int start, int length) {
    std::vector<int> loop;
    for (int at = start, i = 0; i < length; ++i, at = tracer.next(at)) loop.push_back(edge_of(at));
    const auto triangles = triangulate(loop, 0, loop.size() - 1);
    if (!triangles || result.triangles + triangles->size() > static_cast<std::size_t>(Case::kMaxTriangles))
      throw Error(ErrorCode::internal,
                  "marching cubes case " + std::to_string(corners) + " has no valid triangulation");
    for (const auto& triangle : *triangles) {
      for (int corner = 0; corner < 3; ++corner)
        result.edges[3 * result.triangles + corner] =
            static_cast<std::uint8_t>(triangle[static_cast<std::size_t>(corner)]);
      ++result.triangles;
    }
  });
  return result;
}

}  // namespace

std::array<Case, 256> make_case_table() {
  std::array<Case, 256> table;
  for (unsigned corners = 0; corners < table.size(); ++corners) table[corners] = make_case(corners);
  return table;
}

}  // namespace pointskin::surface
