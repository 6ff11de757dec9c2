#include "surface/split_surface.hpp"

#include <bit>
#include <cmath>
#include <utility>

#include "exec/this_space.hpp"

namespace pointskin::surface {
namespace {

using namespace trim;

struct IsSplit {
  SidesView mesh;
  PSK_HD bool operator()(std::int64_t t) const {
    const int corners = mesh.kept_corners(t);
    return corners == 1 || corners == 2;
  }
};

/// An edge by its ends, the smaller id above the larger one.
PSK_HD std::uint64_t edge_key(std::int32_t a, std::int32_t b) {
  const auto low = static_cast<std::uint32_t>(a < b ? a : b);
  const auto high = static_cast<std::uint32_t>(a < b ? b : a);
  return static_cast<std::uint64_t>(low) << 32 | high;
}

/// The two crossed edges of every split triangle.
struct ListEdges {
  SidesView mesh;
  ArrayView<const std::int32_t> split;
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t i) const {
    const SplitTriangle s = mesh.split(split[i]);
    keys[2 * i] = edge_key(s.alone, s.next);
    keys[2 * i + 1] = edge_key(s.alone, s.last);
  }
};

/// The vertices of the trimmed mesh: those that stay, and one on every crossed edge.
struct NewIds {
  ArrayView<const std::int32_t> rank;    // (v) of the vertices that stay
  ArrayView<const std::uint64_t> edges;  // crossed, ascending
  std::int32_t kept;                     // vertices that stay

  PSK_HD std::int32_t on_edge(std::int32_t a, std::int32_t b) const {
    const std::uint64_t key = edge_key(a, b);
    std::int64_t low = 0;
    std::int64_t high = edges.size - 1;
    while (low < high) {
      const std::int64_t middle = (low + high) / 2;
      if (edges[middle] < key)
        low = middle + 1;
      else
        high = middle;
    }
    return kept + static_cast<std::int32_t>(low);
  }
};

struct RankKept {
  ArrayView<const std::int32_t> order;
  ArrayView<std::int32_t> rank;
  PSK_HD void operator()(std::int64_t i) const { rank[order[i]] = static_cast<std::int32_t>(i); }
};

struct CountTriangles {
  SidesView mesh;
  ArrayView<std::int32_t> counts;  // (t + 1)
  PSK_HD void operator()(std::int64_t t) const {
    const int corners = t < mesh.triangles.size ? mesh.kept_corners(t) : 0;
    counts[t] = corners == 3 ? 1 : corners;
  }
};

struct EmitSplitTriangles {
  SidesView mesh;
  NewIds ids;
  ArrayView<const std::int32_t> first;
  ArrayView<Triangle> out;

  PSK_HD void operator()(std::int64_t t) const {
    const int corners = mesh.kept_corners(t);
    if (corners == 0) return;
    Triangle* to = out.data + first[t];
    if (corners == 3) {
      const std::int32_t* v = mesh.triangles[t].data();
      *to = {ids.rank[v[0]], ids.rank[v[1]], ids.rank[v[2]]};
      return;
    }
    const SplitTriangle s = mesh.split(t);
    const std::int32_t on_next = ids.on_edge(s.alone, s.next);
    const std::int32_t on_last = ids.on_edge(s.alone, s.last);
    if (corners == 1) {
      *to = {ids.rank[s.alone], on_next, on_last};
      return;
    }
    const std::int32_t next = ids.rank[s.next];
    const std::int32_t last = ids.rank[s.last];
    if (diagonal(s, s.next, s.last) <= diagonal(s, s.last, s.next)) {
      to[0] = {on_next, next, on_last};
      to[1] = {next, last, on_last};
    } else {
      to[0] = {on_next, next, last};
      to[1] = {on_next, last, on_last};
    }
  }

  /// Squared length from `vertex` to the crossing of the opposite edge, from s.alone to `other`.
  PSK_HD double diagonal(const SplitTriangle& s, std::int32_t vertex, std::int32_t other) const {
    const double t = mesh.crossing(s.alone, other);
    const Vec3f& from = mesh.positions[s.alone];
    const Vec3f& to = mesh.positions[other];
    const Vec3f& p = mesh.positions[vertex];
    const double x = from.x + t * (static_cast<double>(to.x) - from.x) - p.x;
    const double y = from.y + t * (static_cast<double>(to.y) - from.y) - p.y;
    const double z = from.z + t * (static_cast<double>(to.z) - from.z) - p.z;
    return x * x + y * y + z * z;
  }
};

/// Positions, or normals, at the crossings: linear along the edge; normals of unit length again.
struct Interpolate {
  SidesView mesh;
  ArrayView<const std::uint64_t> edges;
  ArrayView<const Vec3f> in;
  bool normalise;
  ArrayView<Vec3f> out;

  /// v / |v|, or `instead` where opposed normals cancel.
  PSK_HD static Vec3f unit(const Vec3f& v, const Vec3f& instead) { return v == Vec3f{} ? instead : outward(-v); }

  PSK_HD void operator()(std::int64_t i) const {
    const auto a = static_cast<std::int32_t>(edges[i] >> 32);
    const auto b = static_cast<std::int32_t>(edges[i] & 0xffffffff);
    const float t = mesh.crossing_upwards(a, b);
    const Vec3f& from = in[a];
    const Vec3f& to = in[b];
    const Vec3f v{from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), from.z + t * (to.z - from.z)};
    out[i] = normalise ? unit(v, from) : v;
  }
};

/// What stays of one array over the vertices, freed where it was.
template <exec::Space Exec>
exec::Buffer<Vec3f> trimmed_vectors(Exec& ex, exec::Buffer<Vec3f> from, ArrayView<const std::int32_t> order,
                                    Interpolate crossings) {
  if (from.empty()) return {};
  exec::Buffer<Vec3f> to = exec::make_buffer<Vec3f>(ex, order.size + crossings.edges.size);
  exec::gather<Vec3f>(ex, from.cview(), order, to.view().part(0, order.size));
  crossings.in = from.cview();
  crossings.out = to.view().part(order.size, crossings.edges.size);
  for_each(ex, "trim.vertices", crossings.edges.size, crossings);
  return to;
}

/// The crossed edges, ascending.
template <exec::Space Exec>
exec::Buffer<std::uint64_t> crossed_edges(Exec& ex, const SidesView& mesh) {
  const exec::Buffer<std::int32_t> split = select(ex, "trim.split", mesh.triangles.size, IsSplit{mesh});
  auto keys = exec::make_buffer<std::uint64_t>(ex, 2 * split.size());
  for_each(ex, "trim.edges", split.size(), ListEdges{mesh, split.cview(), keys.view()});
  return exec::sort_unique(ex, "trim.edges", std::move(keys),
                           32 + std::bit_width(static_cast<std::uint64_t>(mesh.positions.size)));
}

}  // namespace

template <exec::Space Exec>
Surface split_surface(Exec& ex, Surface surface, const SidesView& mesh) {
  const exec::Buffer<std::uint64_t> edges = crossed_edges(ex, mesh);
  exec::Buffer<std::int32_t> order =
      select(ex, "trim.kept", mesh.positions.size, exec::LoadValue<std::uint8_t>{mesh.kept});
  auto rank = exec::make_buffer<std::int32_t>(ex, mesh.positions.size);
  for_each(ex, "trim.kept", order.size(), RankKept{order.cview(), rank.view()});
  const std::int64_t triangles = mesh.triangles.size;
  auto first = exec::make_buffer<std::int32_t>(ex, triangles + 1);
  for_each(ex, "trim.count", triangles + 1, CountTriangles{mesh, first.view()});
  exclusive_scan(ex, "trim.count", first.cview(), first.view());
  Surface trimmed;
  trimmed.triangles = exec::make_buffer<Triangle>(ex, exec::read_element(ex, first.cview(), triangles));
  const NewIds ids{rank.cview(), edges.cview(), static_cast<std::int32_t>(order.size())};
  for_each(ex, "trim.triangles", triangles, EmitSplitTriangles{mesh, ids, first.cview(), trimmed.triangles.view()});
  first.reset();
  rank.reset();
  surface.triangles.reset();
  const Interpolate crossings{mesh, edges.cview(), {}, false, {}};
  trimmed.positions = trimmed_vectors(ex, std::move(surface.positions), order.cview(), crossings);
  Interpolate normals = crossings;
  normals.normalise = true;
  trimmed.normals = trimmed_vectors(ex, std::move(surface.normals), order.cview(), normals);
  return trimmed;
}

PSK_INSTANTIATE(split_surface);

}  // namespace pointskin::surface
