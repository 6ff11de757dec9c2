// A triangle across the line that a surface is cut along: what is left of it, and the vertices on the line.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "surface/edge_vertex.hpp"
#include "surface/trim_pieces.hpp"

namespace pointskin::surface::trim {

/// An edge by the numbers of its ends, below 2^32: the smaller one above the larger one.
PSK_HD inline std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t low = a < b ? a : b;
  const std::uint32_t high = a < b ? b : a;
  return static_cast<std::uint64_t>(low) << 32 | high;
}

/// Place of a key that is among those, which ascend.
PSK_HD inline std::int64_t place_of_edge(ArrayView<const std::uint64_t> edges, std::uint64_t key) {
  std::int64_t low = 0;
  std::int64_t high = edges.size - 1;
  while (low < high) {
    const std::int64_t middle = (low + high) / 2;
    if (edges[middle] < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/// Squared length from `vertex` to the crossing of the opposite edge, from s.alone to `other`.
PSK_HD inline double squared_diagonal(const SidesView& mesh, const SplitTriangle& s, std::int32_t vertex,
                                      std::int32_t other) {
  const double t = mesh.crossing(s.alone, other);
  const Vec3f& from = mesh.positions[s.alone];
  const Vec3f& to = mesh.positions[other];
  const Vec3f& p = mesh.positions[vertex];
  const double x = from.x + t * (static_cast<double>(to.x) - from.x) - p.x;
  const double y = from.y + t * (static_cast<double>(to.y) - from.y) - p.y;
  const double z = from.z + t * (static_cast<double>(to.z) - from.z) - p.z;
  return x * x + y * y + z * z;
}

/// Writes what is left of triangle t, along the shorter diagonal where that has four corners.
/// @param ids  ids.kept(vertex): what a vertex that stays is called, ids.on_edge(a, b): that on a crossed edge
/// @returns the number of triangles, 0 to 2
template <class Ids>
PSK_HD int split_triangle(const SidesView& mesh, std::int64_t t, const Ids& ids, Triangle* to) {
  const int corners = mesh.kept_corners(t);
  if (corners == 0) return 0;
  if (corners == 3) {
    const std::int32_t* v = mesh.triangles[t].data();
    *to = {ids.kept(v[0]), ids.kept(v[1]), ids.kept(v[2])};
    return 1;
  }
  const SplitTriangle s = mesh.split(t);
  const std::int32_t on_next = ids.on_edge(s.alone, s.next);
  const std::int32_t on_last = ids.on_edge(s.alone, s.last);
  if (corners == 1) {
    *to = {ids.kept(s.alone), on_next, on_last};
    return 1;
  }
  const std::int32_t next = ids.kept(s.next);
  const std::int32_t last = ids.kept(s.last);
  if (squared_diagonal(mesh, s, s.next, s.last) <= squared_diagonal(mesh, s, s.last, s.next)) {
    to[0] = {on_next, next, on_last};
    to[1] = {next, last, on_last};
  } else {
    to[0] = {on_next, next, last};
    to[1] = {on_next, last, on_last};
  }
  return 2;
}

/// The point at t from one end of an edge, with the smaller number, to the other.
PSK_HD inline Vec3f on_crossing(const Vec3f& from, const Vec3f& to, float t) {
  return {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), from.z + t * (to.z - from.z)};
}

/// The normal there, of unit length: that of `from` where opposed ones cancel.
PSK_HD inline Vec3f normal_on_crossing(const Vec3f& from, const Vec3f& to, float t) {
  const Vec3f v = on_crossing(from, to, t);
  return v == Vec3f{} ? from : outward(-v);
}

}  // namespace pointskin::surface::trim
