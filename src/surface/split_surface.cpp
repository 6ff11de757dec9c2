#include "surface/split_surface.hpp"

#include <bit>
#include <utility>

#include "exec/this_space.hpp"
#include "surface/split_triangle.hpp"

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

/// The two crossed edges of every split triangle.
struct ListEdges {
  SidesView mesh;
  ArrayView<const std::int32_t> split;
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t i) const {
    const SplitTriangle s = mesh.split(split[i]);
    const auto key = [](std::int32_t a, std::int32_t b) {
      return edge_key(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    };
    keys[2 * i] = key(s.alone, s.next);
    keys[2 * i + 1] = key(s.alone, s.last);
  }
};

/// The vertices of the trimmed mesh: those that stay, and one on every crossed edge.
struct NewIds {
  ArrayView<const std::int32_t> rank;    // (v) of the vertices that stay
  ArrayView<const std::uint64_t> edges;  // crossed, ascending
  std::int32_t stay;                     // vertices that stay

  PSK_HD std::int32_t kept(std::int32_t v) const { return rank[v]; }
  PSK_HD std::int32_t on_edge(std::int32_t a, std::int32_t b) const {
    const std::uint64_t key = edge_key(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    return stay + static_cast<std::int32_t>(place_of_edge(edges, key));
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

  PSK_HD void operator()(std::int64_t t) const { split_triangle(mesh, t, ids, out.data + first[t]); }
};

/// Positions, or normals, at the crossings: linear along the edge; normals of unit length again.
struct Interpolate {
  SidesView mesh;
  ArrayView<const std::uint64_t> edges;
  ArrayView<const Vec3f> in;
  bool normalise;
  ArrayView<Vec3f> out;

  PSK_HD void operator()(std::int64_t i) const {
    const auto a = static_cast<std::int32_t>(edges[i] >> 32);
    const auto b = static_cast<std::int32_t>(edges[i] & 0xffffffff);
    const float t = mesh.crossing_upwards(a, b);
    out[i] = normalise ? normal_on_crossing(in[a], in[b], t) : on_crossing(in[a], in[b], t);
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
