// A mesh is closed where the boundary of its triangles is nothing: each edge appears an even number of times, and in a
// mesh that is oriented as often one way as the other. Both are sums over the triangles' edges, in Z/2 and in Z. Rather
// than one counter an edge, the sums run over a 64-bit hash of each edge, so that no edge need be found again.
// Source of the hash: Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014 (the finaliser
// of SplitMix64).
#include "mesh/glance.hpp"

#include <limits>

#include "exec/this_space.hpp"
#include "mesh/joined_vertices.hpp"

namespace pointskin::mesh_detail {
namespace {

PSK_HD inline std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

/// What is left of the edges when equal ones have cancelled: 0 and 0 for a mesh that is closed and oriented.
struct EdgeSums {
  std::uint64_t even = 0;      ///< exclusive or: 0 where every edge appears an even number of times
  std::uint64_t balanced = 0;  ///< signed by direction: 0 where every edge appears as often either way

  PSK_HD void add(std::int32_t from, std::int32_t to) {
    const auto low = static_cast<std::uint64_t>(from < to ? from : to);
    const auto high = static_cast<std::uint64_t>(from < to ? to : from);
    const std::uint64_t hash = mix((high << 32U | low) + 1);  // 0 would be hashed to 0
    even ^= hash;
    balanced += from < to ? hash : 0 - hash;
  }
};

struct EdgesOf {
  ArrayView<const Triangle> triangles;
  PSK_HD EdgeSums operator()(std::int64_t i) const {
    const std::int32_t* const t = triangles[i].data();
    EdgeSums sums;
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return sums;
    sums.add(t[0], t[1]);
    sums.add(t[1], t[2]);
    sums.add(t[2], t[0]);
    return sums;
  }
};

struct AddEdges {
  static constexpr bool kAnyOrder = true;
  PSK_HD EdgeSums operator()(const EdgeSums& a, const EdgeSums& b) const {
    return {a.even ^ b.even, a.balanced + b.balanced};
  }
};

struct BeginsPiece {
  JoinedView joined;
  PSK_HD std::int64_t operator()(std::int64_t v) const { return joined.begins_piece(v) ? 1 : 0; }
};

struct Plus {
  static constexpr bool kAnyOrder = true;
  PSK_HD std::int64_t operator()(std::int64_t a, std::int64_t b) const { return a + b; }
};

constexpr std::int64_t kNoTriangle = std::numeric_limits<std::int64_t>::max();

struct BadTriangle {
  std::int64_t vertices;
  ArrayView<const Triangle> triangles;
  PSK_HD std::int64_t operator()(std::int64_t i) const {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = triangles[i].data()[k];
      if (v < 0 || v >= vertices) return i;
    }
    return kNoTriangle;
  }
};

struct Smaller {
  static constexpr bool kAnyOrder = true;
  PSK_HD std::int64_t operator()(std::int64_t a, std::int64_t b) const { return a < b ? a : b; }
};

}  // namespace

template <exec::Space Exec>
std::int64_t find_bad_triangle(Exec& ex, std::int64_t vertices, ArrayView<const Triangle> triangles) {
  if (triangles.empty()) return -1;
  const auto first =
      exec::reduce<std::int64_t>(ex, "mesh.check", triangles.size, BadTriangle{vertices, triangles}, Smaller{});
  return first == kNoTriangle ? -1 : first;
}

template <exec::Space Exec>
MeshGlance glance(Exec& ex, std::int64_t vertices, ArrayView<const Triangle> triangles) {
  MeshGlance seen;
  if (vertices == 0 || triangles.empty()) return seen;
  const Joined joined = join_vertices(ex, vertices, triangles);
  seen.components = exec::reduce<std::int64_t>(ex, "mesh.pieces", vertices, BeginsPiece{joined.view()}, Plus{});
  const auto sums = exec::reduce<EdgeSums>(ex, "mesh.edges", triangles.size, EdgesOf{triangles}, AddEdges{});
  seen.closed = seen.components > 0 && sums.even == 0;
  seen.oriented = seen.closed && sums.balanced == 0;
  return seen;
}

PSK_INSTANTIATE(find_bad_triangle);
PSK_INSTANTIATE(glance);

}  // namespace pointskin::mesh_detail
