#include "surface/pieces.hpp"

#include <utility>

#include "exec/this_space.hpp"
#include "surface/piece_rule.hpp"
#include "surface/split_surface.hpp"

namespace pointskin::surface {
namespace {

using namespace trim;

/// Adds the triangles of a block to their pieces, those of one piece in a row at once.
struct SumExtents {
  static constexpr std::int64_t kTriangles = 32;
  SidesView mesh;
  exec::DisjointSets sets;
  PieceExtent* extents;  // (v) of a piece at its root; else nothing
  ArrayView<const float> density;

  PSK_HD void operator()(std::int64_t block) const {
    const std::int64_t first = block * kTriangles;
    const std::int64_t end = first + kTriangles < mesh.triangles.size ? first + kTriangles : mesh.triangles.size;
    std::int32_t piece = -1;
    PieceExtent sum;
    for (std::int64_t t = first; t < end; ++t) {
      const std::int32_t root = sets.root(mesh.triangles[t].data()[0]);
      if (root != piece) flush(piece, sum);
      piece = root;
      const double area = mesh.area(t);
      sum.add_triangle(area);
      if (!density.empty()) sum.add_samples(area, density[mesh.triangles[t].data()[0]]);
    }
    flush(piece, sum);
  }
  PSK_HD void flush(std::int32_t piece, PieceExtent& sum) const {
    if (sum.triangles == 0) return;
    exec::add(&extents[piece].area, sum.area);
    exec::add(&extents[piece].triangles, sum.triangles);
    if (sum.samples != 0) exec::add(&extents[piece].samples, sum.samples);
    sum = {};
  }
};

struct WholeOf {
  exec::DisjointSets sets;
  ArrayView<const PieceExtent> extents;
  PSK_HD WholeOfPieces operator()(std::int64_t v) const {
    if (!sets.is_root(static_cast<std::int32_t>(v)) || extents[v].triangles == 0) return {};
    return {extents[v].area, extents[v].area, 1, v};
  }
};

struct MarkKept {
  exec::DisjointSets sets;
  ArrayView<const PieceExtent> extents;
  PieceRule rule;
  ArrayView<std::uint8_t> kept;
  PSK_HD void operator()(std::int64_t v) const {
    const std::int32_t root = sets.root(static_cast<std::int32_t>(v));
    kept[v] = extents[root].triangles > 0 && rule.stays(root, extents[root]) ? 1 : 0;
  }
};

struct Removed {
  std::int64_t pieces = 0, triangles = 0;
};
struct RemovedAt {
  exec::DisjointSets sets;
  ArrayView<const PieceExtent> extents;
  PieceRule rule;
  PSK_HD Removed operator()(std::int64_t v) const {
    if (!sets.is_root(static_cast<std::int32_t>(v)) || extents[v].triangles == 0 || rule.stays(v, extents[v]))
      return {};
    return {1, static_cast<std::int64_t>(extents[v].triangles)};
  }
};
struct AddRemoved {
  PSK_HD Removed operator()(const Removed& a, const Removed& b) const {
    return {a.pieces + b.pieces, a.triangles + b.triangles};
  }
};

}  // namespace

template <exec::Space Exec>
Surface keep_pieces(Exec& ex, Surface surface, const PieceOptions& options, PieceCounts& counts) {
  const std::int64_t vertices = surface.positions.size();
  const std::int64_t triangles = surface.triangles.size();
  if (triangles == 0) return surface;
  auto kept = exec::make_buffer<std::uint8_t>(ex, vertices);
  exec::fill(ex, kept.view(), std::uint8_t{1});
  const SidesView mesh{surface.positions.cview(), surface.triangles.cview(), {}, 0, kept.cview()};
  {
    exec::Buffer<std::int32_t> parents = exec::iota(ex, vertices);
    const exec::DisjointSets sets{parents.view()};
    for_each(ex, "pieces.unite", triangles, Unite{mesh, sets});
    auto extents = exec::make_buffer<PieceExtent>(ex, vertices);
    exec::fill(ex, extents.view(), PieceExtent{});
    const std::int64_t blocks = (triangles + SumExtents::kTriangles - 1) / SumExtents::kTriangles;
    for_each(ex, "pieces.sum", blocks, SumExtents{mesh, sets, extents.data(), options.density});
    const auto whole =
        exec::reduce<WholeOfPieces>(ex, "pieces.whole", vertices, WholeOf{sets, extents.cview()}, AddWholes{});
    const PieceRule rule = rule_of(options, whole);
    const auto removed =
        exec::reduce<Removed>(ex, "pieces.removed", vertices, RemovedAt{sets, extents.cview(), rule}, AddRemoved{});
    counts = {whole.pieces, removed.pieces, removed.triangles};
    if (removed.pieces == 0) return surface;
    if (removed.triangles == triangles) return {};
    for_each(ex, "pieces.mark", vertices, MarkKept{sets, extents.cview(), rule, kept.view()});
  }
  return split_surface(ex, std::move(surface), mesh);
}

PSK_INSTANTIATE(keep_pieces);

}  // namespace pointskin::surface
