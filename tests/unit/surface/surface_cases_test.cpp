// The loops of a cell and the 256 cases derived from them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "octree/keys.hpp"
#include "support/shapes.hpp"
#include "surface/case_table.hpp"
#include "surface/cell_tracer.hpp"

namespace pointskin {
namespace {

using surface::Case;
using surface::CellTracer;
using Point = std::array<int, 3>;

/// The two corners of edge number axis * 4 + side_b * 2 + side_c.
std::array<Point, 2> ends_of(int edge) {
  const auto axis = static_cast<std::size_t>(edge / 4);
  Point low{};
  low[(axis + 1) % 3] = edge / 2 & 1;
  low[(axis + 2) % 3] = edge & 1;
  Point high = low;
  high[axis] = 1;
  return {low, high};
}

bool is_inside(unsigned corners, const Point& p) { return (corners >> octree::slot_of(p[0], p[1], p[2]) & 1) != 0; }

bool is_crossed(unsigned corners, int edge) {
  return is_inside(corners, ends_of(edge)[0]) != is_inside(corners, ends_of(edge)[1]);
}

/// Twice the middle of an edge.
Point middle_of(int edge) {
  const auto [a, b] = ends_of(edge);
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// Faces (axis, side) that hold both edges; two at most.
std::vector<std::pair<std::size_t, int>> common_faces(int e, int f) {
  std::vector<std::pair<std::size_t, int>> faces;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1})
      if (middle_of(e)[axis] == 2 * side && middle_of(f)[axis] == 2 * side) faces.emplace_back(axis, side);
  return faces;
}

using Segment = std::pair<int, int>;

/// How often the triangles of a case run along each directed pair of edges.
std::map<Segment, int> directed_sides(const Case& c) {
  std::map<Segment, int> sides;
  for (int t = 0; t < c.triangles; ++t)
    for (int k = 0; k < 3; ++k) ++sides[{c.edges[3 * t + k], c.edges[3 * t + (k + 1) % 3]}];
  return sides;
}

std::vector<Segment> boundary_of(const Case& c) {
  std::vector<Segment> boundary;
  const auto sides = directed_sides(c);
  for (const auto& [side, count] : sides)
    if (!sides.contains({side.second, side.first})) boundary.push_back(side);
  return boundary;
}

const std::array<Case, 256>& cases() {
  static const std::array<Case, 256> table = surface::make_case_table();
  return table;
}

TEST(CaseTable, UsesExactlyTheCrossedEdges) {
  for (unsigned corners = 0; corners < 256; ++corners) {
    std::set<int> used;
    for (int i = 0; i < 3 * cases()[corners].triangles; ++i) used.insert(cases()[corners].edges[i]);
    for (int edge = 0; edge < 12; ++edge)
      ASSERT_EQ(used.contains(edge), is_crossed(corners, edge)) << "case " << corners << ", edge " << edge;
  }
}

TEST(CaseTable, BoundsTheTrianglesByOneSegmentInAndOneOutOfEveryCrossing) {
  for (unsigned corners = 0; corners < 256; ++corners) {
    for (const auto& [side, count] : directed_sides(cases()[corners])) ASSERT_EQ(count, 1) << "case " << corners;
    std::map<int, int> starts;
    std::map<int, int> ends;
    for (const auto& [from, to] : boundary_of(cases()[corners])) {
      ASSERT_FALSE(common_faces(from, to).empty()) << "case " << corners << ": the boundary must lie in the faces";
      ++starts[from];
      ++ends[to];
    }
    for (int edge = 0; edge < 12; ++edge) {
      ASSERT_EQ(starts[edge], is_crossed(corners, edge) ? 1 : 0) << "case " << corners << ", edge " << edge;
      ASSERT_EQ(ends[edge], is_crossed(corners, edge) ? 1 : 0) << "case " << corners << ", edge " << edge;
    }
  }
}

TEST(CaseTable, HasNoDiagonalInAFaceOfTheCell) {
  for (unsigned corners = 0; corners < 256; ++corners) {
    const auto sides = directed_sides(cases()[corners]);
    for (const auto& [side, count] : sides) {
      if (!sides.contains({side.second, side.first})) continue;  // on the boundary
      ASSERT_TRUE(common_faces(side.first, side.second).empty())
          << "case " << corners << ": diagonal from edge " << side.first << " to " << side.second;
    }
  }
}

TEST(CaseTable, LetsQuadrilateralsBeCutAlongEitherDiagonal) {
  int quadrilaterals = 0;
  for (unsigned corners = 0; corners < 256; ++corners) {
    const Case& c = cases()[corners];
    if (!c.is_quadrilateral()) continue;
    ++quadrilaterals;
    const std::array<std::uint8_t, 4> loop{c.edges[3], c.edges[0], c.edges[1], c.edges[2]};
    Case other;
    other.triangles = 2;
    const std::array<int, 6> cut{0, 1, 2, 0, 2, 3};
    for (std::size_t i = 0; i < cut.size(); ++i) other.edges[i] = loop[static_cast<std::size_t>(cut[i])];
    ASSERT_EQ(boundary_of(other), boundary_of(c)) << "case " << corners;
    ASSERT_TRUE(common_faces(loop[0], loop[2]).empty()) << "case " << corners;
    ASSERT_TRUE(common_faces(loop[1], loop[3]).empty()) << "case " << corners;
  }
  EXPECT_GE(quadrilaterals, 6 + 12 + 12);  // four corners of a face; the two of an edge, inside or outside
}

/// (b - a) x (p - a) along `axis`, doubled coordinates.
int turn(std::size_t axis, const Point& a, const Point& b, const Point& p) {
  const std::size_t u = (axis + 1) % 3;
  const std::size_t v = (axis + 2) % 3;
  return (b[u] - a[u]) * (p[v] - a[v]) - (b[v] - a[v]) * (p[u] - a[u]);
}

// With corner 0 alone inside, the outward triangle runs x -> y -> z. Its segment from the x edge to the y edge lies in
// the face z = 0; seen from outside of the cell, from below, the inside corner is on its right. The surface continues
// over every segment, so the inside is on the right of all segments of all cases.
TEST(CaseTable, HasTheInsideOnTheRightOfEverySegmentSeenFromOutsideOfTheCell) {
  for (unsigned corners = 0; corners < 256; ++corners)
    for (const auto& [from, to] : boundary_of(cases()[corners])) {
      const auto faces = common_faces(from, to);
      ASSERT_EQ(faces.size(), 1U);
      const auto [axis, side] = faces[0];
      for (const int edge : {from, to})
        for (const Point& end : ends_of(edge)) {
          const Point doubled{2 * end[0], 2 * end[1], 2 * end[2]};
          const int left = (side == 0 ? -1 : 1) * turn(axis, middle_of(from), middle_of(to), doubled);
          if (is_inside(corners, end)) {
            ASSERT_LT(left, 0) << "case " << corners;
          } else {
            ASSERT_GT(left, 0) << "case " << corners;
          }
        }
    }
}

TEST(CaseTable, TurnsASingleInsideCornersTriangleAwayFromIt) {
  for (int slot = 0; slot < 8; ++slot) {
    const Case& c = cases()[std::size_t{1} << slot];
    ASSERT_EQ(c.triangles, 1);
    const Point a = middle_of(c.edges[0]);
    const Point b = middle_of(c.edges[1]);
    const Point d = middle_of(c.edges[2]);
    const Point corner{2 * octree::slot_x(slot), 2 * octree::slot_y(slot), 2 * octree::slot_z(slot)};
    int volume = 0;  // (b - a) x (d - a) . (corner - a): negative if the normal points away from the corner
    for (std::size_t axis = 0; axis < 3; ++axis) volume += turn(axis, a, b, d) * (corner[axis] - a[axis]);
    EXPECT_LT(volume, 0) << "slot " << slot;
  }
}

/// True if some face has its inside corners on one diagonal and its outside corners on the other.
bool has_ambiguous_face(unsigned corners) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1}) {
      bool inside[4];
      for (int i = 0; i < 4; ++i) {
        Point p{};
        p[axis] = side;
        p[(axis + 1) % 3] = i >> 1;
        p[(axis + 2) % 3] = i & 1;
        inside[i] = is_inside(corners, p);
      }
      if (inside[0] == inside[3] && inside[1] == inside[2] && inside[0] != inside[1]) return true;
    }
  return false;
}

TEST(CaseTable, HasAsManyTrianglesForTheComplementWhereNoFaceIsAmbiguous) {
  int compared = 0;
  for (unsigned corners = 0; corners < 256; ++corners) {
    if (has_ambiguous_face(corners)) continue;
    ++compared;
    EXPECT_EQ(cases()[corners].triangles, cases()[255 - corners].triangles) << "case " << corners;
  }
  EXPECT_GT(compared, 100);
}

TEST(CaseTable, LeavesUniformCellsEmpty) {
  EXPECT_EQ(cases()[0].triangles, 0);
  EXPECT_EQ(cases()[255].triangles, 0);
  for (unsigned corners = 1; corners < 255; ++corners) EXPECT_GT(cases()[corners].triangles, 0) << "case " << corners;
}

// ---- Cells with finer neighbours

/// A cell's finer neighbours: bit 2 axis + side for faces, edge bits for edges (those of subdivided faces included).
struct Subdivision {
  unsigned faces = 0, edges = 0;
};

Subdivision random_subdivision(test::Random& random) {
  Subdivision s{static_cast<unsigned>(random.below(64)),
                static_cast<unsigned>(random.below(4096) & random.below(4096))};
  for (int edge = 0; edge < 12; ++edge)
    for (const auto& [axis, side] : common_faces(edge, edge))
      if ((s.faces >> (2 * axis + static_cast<unsigned>(side)) & 1) != 0)
        s.edges |= CellTracer::edge_bit(edge / 4, edge / 2 & 1, edge & 1);
  return s;
}

/// Crossings that the cell has: of its 12 edges, halved where split, and of the 4 inner edges of subdivided faces.
std::set<int> expected_crossings(std::uint32_t inside, const Subdivision& s) {
  std::set<int> crossings;
  const auto add = [&](const Point& p, const Point& q) {
    const int i = surface::grid_index(p[0], p[1], p[2]);
    const int j = surface::grid_index(q[0], q[1], q[2]);
    if ((inside >> i & 1) != (inside >> j & 1)) crossings.insert(surface::crossing_between(i, j));
  };
  for (int edge = 0; edge < 12; ++edge) {
    auto [a, b] = ends_of(edge);
    for (int& x : a) x *= 2;
    for (int& x : b) x *= 2;
    if ((s.edges & CellTracer::edge_bit(edge / 4, edge / 2 & 1, edge & 1)) != 0) {
      add(a, middle_of(edge));
      add(middle_of(edge), b);
    } else {
      add(a, b);
    }
  }
  for (std::size_t face = 0; face < 6; ++face) {
    if ((s.faces >> face & 1) == 0) continue;
    Point centre{1, 1, 1};
    centre[face / 2] = face % 2 == 0 ? 0 : 2;
    for (const std::size_t axis : {(face / 2 + 1) % 3, (face / 2 + 2) % 3})
      for (const int at : {0, 2}) {
        Point end = centre;
        end[axis] = at;
        add(centre, end);
      }
  }
  return crossings;
}

TEST(CellTracer, WalksThroughEveryCrossingOnceForAnySubdivisionAndAnySigns) {
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    test::Random random(seed);
    const Subdivision s = random_subdivision(random);
    const auto inside = static_cast<std::uint32_t>(random.below(std::int64_t{1} << 27));
    CellTracer tracer(inside);
    for (int face = 0; face < 6; ++face) tracer.add_face(face / 2, face % 2, (s.faces >> face & 1) != 0, s.edges);
    std::set<int> walked;
    int steps = 0;
    tracer.for_loops([&](int start, int length) {
      for (int i = 0, at = start; i < length; ++i, at = tracer.next(at)) walked.insert(at);
      steps += length;
    });
    ASSERT_EQ(walked, expected_crossings(inside, s)) << "seed " << seed;
    ASSERT_EQ(steps, static_cast<int>(walked.size())) << "seed " << seed << ": loops must not meet";
  }
}

TEST(CellTracer, FindsNoLoopInAUniformCell) {
  for (const std::uint32_t inside : {0U, (1U << 27) - 1}) {
    CellTracer tracer(inside);
    for (int face = 0; face < 6; ++face) tracer.add_face(face / 2, face % 2, face % 2 == 0, 0xfffU);
    int loops = 0;
    tracer.for_loops([&](int, int) { ++loops; });
    EXPECT_EQ(loops, 0);
  }
}

}  // namespace
}  // namespace pointskin
