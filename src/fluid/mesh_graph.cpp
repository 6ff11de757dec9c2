#include "fluid/mesh_graph.hpp"

#include <pointskin/error.hpp>

#include <cmath>
#include <limits>
#include <utility>

#include "exec/atomic.hpp"
#include "exec/disjoint_sets.hpp"
#include "exec/this_space.hpp"
#include "surface/volume.hpp"

namespace pointskin::fluid {
namespace {

struct CornerKeys {
  ArrayView<const Triangle> triangles;
  ArrayView<std::uint64_t> keys;
  ArrayView<std::int32_t> corners;
  PSK_HD void operator()(std::int64_t c) const {
    keys[c] = static_cast<std::uint64_t>(triangles[c / 3].data()[c % 3]);
    corners[c] = static_cast<std::int32_t>(c);
  }
};

/// Where the corners of every vertex begin among the sorted ones.
struct FindBegins {
  ArrayView<const std::uint64_t> keys;
  ArrayView<std::int32_t> begin;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t own = i < keys.size ? static_cast<std::int64_t>(keys[i]) : begin.size - 1;
    const std::int64_t previous = i == 0 ? -1 : static_cast<std::int64_t>(keys[i - 1]);
    for (std::int64_t v = previous + 1; v <= own; ++v) begin[v] = static_cast<std::int32_t>(i);
  }
};

struct FansView {
  ArrayView<const std::int32_t> begin, corners;
  ArrayView<const Triangle> triangles;

  /// Calls visit(triangle, which corner of it) for the triangles around a vertex.
  template <class Visit>
  PSK_HD void around(std::int64_t vertex, const Visit& visit) const {
    for (std::int32_t i = begin[vertex]; i < begin[vertex + 1]; ++i) visit(triangles[corners[i] / 3], corners[i] % 3);
  }
};

/// The vertex after the one that each entry of the fans belongs to. In a closed mesh each neighbour follows once.
struct FindNext {
  ArrayView<const std::int32_t> corners;
  ArrayView<const Triangle> triangles;
  ArrayView<std::int32_t> next;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t corner = corners[i] % 3;
    next[i] = triangles[corners[i] / 3].data()[corner == 2 ? 0 : corner + 1];
  }
};

struct SmoothVertex {
  ArrayView<const std::int32_t> begin, next;
  ArrayView<const float> weights;
  ArrayView<const Vec3f> in;
  ArrayView<Vec3f> out;
  PSK_HD void operator()(std::int64_t v) const {
    const Vec3f p = in[v];
    Vec3f sum{};
    for (std::int32_t i = begin[v]; i < begin[v + 1]; ++i) {
      const Vec3f other = in[next[i]];
      sum.x += other.x - p.x;
      sum.y += other.y - p.y;
      sum.z += other.z - p.z;
    }
    const std::int32_t count = begin[v + 1] - begin[v];
    const float step = count == 0 ? 0.0F : (weights.empty() ? 1.0F : weights[v]) / static_cast<float>(count);
    out[v] = {p.x + step * sum.x, p.y + step * sum.y, p.z + step * sum.z};
  }
};

struct NormalOfVertex {
  FansView fans;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec3f> normals;
  PSK_HD void operator()(std::int64_t v) const {
    double x = 0;
    double y = 0;
    double z = 0;
    fans.around(v, [&](const Triangle& t, int) {
      const Vec3f a = positions[t.data()[0]];
      const Vec3f b = positions[t.data()[1]];
      const Vec3f c = positions[t.data()[2]];
      const double ux = double{b.x} - a.x;
      const double uy = double{b.y} - a.y;
      const double uz = double{b.z} - a.z;
      const double wx = double{c.x} - a.x;
      const double wy = double{c.y} - a.y;
      const double wz = double{c.z} - a.z;
      x += uy * wz - uz * wy;
      y += uz * wx - ux * wz;
      z += ux * wy - uy * wx;
    });
    const double length = std::sqrt(x * x + y * y + z * z);
    if (!(length > 0)) {  // smoothing has drawn the piece together: all directions are alike there
      normals[v] = {0, 0, 1};
      return;
    }
    const double inverse = 1 / length;
    normals[v] = {static_cast<float>(x * inverse), static_cast<float>(y * inverse), static_cast<float>(z * inverse)};
  }
};

// ---- Components --------------------------------------------------------------------------------------------------

struct UniteCorners {
  ArrayView<const Triangle> triangles;
  exec::DisjointSets sets;
  PSK_HD void operator()(std::int64_t t) const {
    const std::int32_t* v = triangles[t].data();
    sets.unite(v[0], v[1]);
    sets.unite(v[0], v[2]);
  }
};

/// Adds the triangles' volumes to their components.
struct AddVolumes {
  surface::SixVolumes of;
  exec::DisjointSets sets;
  ArrayView<std::uint64_t> volumes;
  PSK_HD void operator()(std::int64_t t) const {
    exec::add(volumes.data + sets.root(of.triangles[t].data()[0]), of(t));
  }
};

struct IsKept {
  exec::DisjointSets sets;
  ArrayView<const std::uint64_t> volumes;
  std::int64_t least;
  PSK_HD bool operator()(std::int64_t vertex) const {
    const auto volume = static_cast<std::int64_t>(volumes[sets.root(static_cast<std::int32_t>(vertex))]);
    return volume >= least || volume <= -least;
  }
};

struct IsRemovedRoot {
  IsKept kept;
  PSK_HD std::int64_t operator()(std::int64_t vertex) const {
    return kept.sets.is_root(static_cast<std::int32_t>(vertex)) && !kept(vertex) ? 1 : 0;
  }
};

struct HasKeptCorner {
  ArrayView<const Triangle> triangles;
  IsKept kept;
  PSK_HD bool operator()(std::int64_t t) const { return kept(triangles[t].data()[0]); }
};

struct SetRank {
  ArrayView<const std::int32_t> kept;
  ArrayView<std::int32_t> rank;
  PSK_HD void operator()(std::int64_t i) const { rank[kept[i]] = static_cast<std::int32_t>(i); }
};

struct MoveTriangle {
  ArrayView<const Triangle> in;
  ArrayView<const std::int32_t> kept, rank;
  ArrayView<Triangle> out;
  PSK_HD void operator()(std::int64_t t) const {
    const std::int32_t* v = in[kept[t]].data();
    out[t] = {rank[v[0]], rank[v[1]], rank[v[2]]};
  }
};

}  // namespace

template <exec::Space Exec>
Fans find_fans(Exec& ex, ArrayView<const Triangle> triangles, std::int64_t vertices) {
  constexpr const char* kLabel = "fluid.fans";
  if (triangles.size > std::numeric_limits<std::int32_t>::max() / 3)
    throw Error(ErrorCode::over_limit, "the mesh has too many triangles; choose larger cells");
  Fans fans;
  const std::int64_t n = 3 * triangles.size;
  auto keys = exec::make_buffer<std::uint64_t>(ex, n);
  fans.corners = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, kLabel, n, CornerKeys{triangles, keys.view(), fans.corners.view()});
  int bits = 1;
  while (std::int64_t{1} << bits < vertices) ++bits;
  sort_pairs(ex, kLabel, keys, fans.corners, bits);
  fans.begin = exec::make_buffer<std::int32_t>(ex, vertices + 1);
  for_each(ex, kLabel, n + 1, FindBegins{keys.cview(), fans.begin.view()});
  return fans;
}

template <exec::Space Exec>
void smooth(Exec& ex, const Fans& fans, ArrayView<const Triangle> triangles, ArrayView<const float> weights,
            int iterations, exec::Buffer<Vec3f>& positions) {
  auto next = exec::make_buffer<std::int32_t>(ex, fans.corners.size());
  for_each(ex, "fluid.smooth", next.size(), FindNext{fans.corners.cview(), triangles, next.view()});
  auto moved = exec::make_buffer<Vec3f>(ex, positions.size());
  for (int i = 0; i < iterations; ++i) {
    for_each(ex, "fluid.smooth", positions.size(),
             SmoothVertex{fans.begin.cview(), next.cview(), weights, positions.cview(), moved.view()});
    positions.swap(moved);
  }
}

template <exec::Space Exec>
exec::Buffer<Vec3f> normals_of(Exec& ex, const Fans& fans, ArrayView<const Triangle> triangles,
                               ArrayView<const Vec3f> positions) {
  auto normals = exec::make_buffer<Vec3f>(ex, positions.size);
  for_each(ex, "fluid.normals", positions.size,
           NormalOfVertex{{fans.begin.cview(), fans.corners.cview(), triangles}, positions, normals.view()});
  return normals;
}

template <exec::Space Exec>
std::int64_t remove_small_components(Exec& ex, int depth, double least_cells, surface::Surface& mesh) {
  constexpr const char* kLabel = "fluid.components";
  const double per_cell = std::ldexp(1.0, 3 * (surface::depth_of_quanta(depth) - depth));
  const double least = 6 * per_cell * least_cells;
  const std::int64_t n = mesh.positions.size();
  exec::Buffer<std::int32_t> parents = exec::iota(ex, n);
  const exec::DisjointSets sets{parents.view()};
  for_each(ex, kLabel, mesh.triangles.size(), UniteCorners{mesh.triangles.cview(), sets});
  auto volumes = exec::make_buffer<std::uint64_t>(ex, n);
  exec::fill(ex, volumes.view(), std::uint64_t{0});
  for_each(ex, kLabel, mesh.triangles.size(), AddVolumes{surface::volumes_of(depth, mesh), sets, volumes.view()});
  constexpr double kLargest = 9e18;
  const IsKept keep{sets, volumes.cview(), static_cast<std::int64_t>(least < kLargest ? std::ceil(least) : kLargest)};
  const auto removed = exec::reduce<std::int64_t>(ex, kLabel, n, IsRemovedRoot{keep}, exec::Plus{});
  if (removed == 0) return 0;
  const exec::Buffer<std::int32_t> vertices = select(ex, kLabel, n, keep);
  const exec::Buffer<std::int32_t> triangles =
      select(ex, kLabel, mesh.triangles.size(), HasKeptCorner{mesh.triangles.cview(), keep});
  auto rank = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, kLabel, vertices.size(), SetRank{vertices.cview(), rank.view()});
  surface::Surface left{
      exec::make_buffer<Vec3f>(ex, vertices.size()), {}, exec::make_buffer<Triangle>(ex, triangles.size())};
  exec::gather(ex, mesh.positions.cview(), vertices.cview(), left.positions.view());
  for_each(ex, kLabel, triangles.size(),
           MoveTriangle{mesh.triangles.cview(), triangles.cview(), rank.cview(), left.triangles.view()});
  mesh = std::move(left);
  return removed;
}

PSK_INSTANTIATE(find_fans);
PSK_INSTANTIATE(smooth);
PSK_INSTANTIATE(normals_of);
PSK_INSTANTIATE(remove_small_components);

}  // namespace pointskin::fluid
