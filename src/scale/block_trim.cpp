#include "scale/block_trim.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "exec/disjoint_sets.hpp"
#include "surface/split_triangle.hpp"

namespace pointskin::scale {
namespace {

using namespace surface::trim;

RankedBits vertices_within(const BlockMeshes& meshes, std::size_t column, float limit) {
  constexpr std::int64_t kAtOnce = 64 << 10;
  RankedBits kept(meshes.vertices());
  std::vector<float> values;
  for (std::int64_t first = 0; first < meshes.vertices(); first += std::ssize(values)) {
    values.resize(static_cast<std::size_t>(std::min(kAtOnce, meshes.vertices() - first)));
    meshes.read_column(column, first, std::ssize(values), reinterpret_cast<std::byte*>(values.data()));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] <= limit) kept.set(first + static_cast<std::int64_t>(i));
  }
  return kept;
}

/// The connected pieces of both sides in a part.
struct PiecesOfSides {
  std::vector<std::int32_t> piece_of;  ///< (v)
  std::vector<std::uint64_t> areas;    ///< (pieces) in area_units()
  std::vector<std::uint8_t> kept;      ///< (pieces) their side

  explicit PiecesOfSides(const SidesView& mesh) : piece_of(static_cast<std::size_t>(mesh.positions.size)) {
    std::vector<std::int32_t> parents(piece_of.size());
    std::iota(parents.begin(), parents.end(), 0);
    const exec::DisjointSets sets{{parents.data(), std::ssize(parents)}};
    const Unite unite{mesh, sets};
    for (std::int64_t t = 0; t < mesh.triangles.size; ++t) unite(t);
    std::vector<std::uint64_t> sums(parents.size(), 0);  // at the roots
    const SumAreas sum{mesh, sets, {sums.data(), std::ssize(sums)}};
    for (std::int64_t first = 0; first < mesh.triangles.size; first += SumAreas::kTriangles)
      sum(first / SumAreas::kTriangles);
    for (std::size_t v = 0; v < parents.size(); ++v) {
      const auto root = static_cast<std::size_t>(sets.root(static_cast<std::int32_t>(v)));  // at most v
      piece_of[v] = root == v ? static_cast<std::int32_t>(areas.size()) : piece_of[root];
      if (root != v) continue;
      areas.push_back(sums[v]);
      kept.push_back(mesh.kept[static_cast<std::int64_t>(v)]);
    }
  }
};

/// Pieces of all parts, joined where parts share vertices.
class JoinedSides {
 public:
  explicit JoinedSides(const RankedBits& shared)
      : shared_(&shared), piece_at_(static_cast<std::size_t>(shared.ones()), -1) {}

  void add(const PiecesOfSides& pieces, const std::vector<std::int64_t>& vertices) {
    const auto before = static_cast<std::int32_t>(areas_.size());
    begins_.push_back(before);
    areas_.insert(areas_.end(), pieces.areas.begin(), pieces.areas.end());
    kept_.insert(kept_.end(), pieces.kept.begin(), pieces.kept.end());
    for (auto p = before; p < std::ssize(areas_); ++p) parents_.push_back(p);
    const exec::DisjointSets sets = this->sets();
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      if (!shared_->at(vertices[v])) continue;
      const std::int32_t piece = before + pieces.piece_of[v];
      std::int32_t& there = piece_at_[static_cast<std::size_t>(shared_->before(vertices[v]))];
      if (there < 0)
        there = piece;
      else
        sets.unite(there, piece);
    }
  }

  /// Once all parts are there.
  SmallPieces count_small(std::uint64_t least) {
    least_ = least;
    const exec::DisjointSets sets = this->sets();
    for (std::int32_t p = 0; p < std::ssize(areas_); ++p)
      if (const std::int32_t root = sets.root(p); root != p) at(root) += at(p);
    SmallPieces small;
    for (std::int32_t p = 0; p < std::ssize(areas_); ++p) {
      if (!sets.is_root(p) || at(p) >= least) continue;
      ++(kept_[static_cast<std::size_t>(p)] != 0 ? small.kept : small.cut);
    }
    return small;
  }

  /// After count_small(), of the piece of a part.
  [[nodiscard]] bool is_small(std::size_t part, std::int32_t piece) {
    return at(sets().root(begins_[part] + piece)) < least_;
  }

 private:
  [[nodiscard]] exec::DisjointSets sets() { return {{parents_.data(), std::ssize(parents_)}}; }
  [[nodiscard]] std::uint64_t& at(std::int32_t piece) { return areas_[static_cast<std::size_t>(piece)]; }

  const RankedBits* shared_;
  std::vector<std::int32_t> piece_at_;  ///< (shared) a piece that has the vertex, or -1
  std::vector<std::int32_t> begins_;    ///< (parts) their first pieces
  std::vector<std::int32_t> parents_;
  std::vector<std::uint64_t> areas_;
  std::vector<std::uint8_t> kept_;
  std::uint64_t least_ = 0;
};

class Cutter {
 public:
  Cutter(const BlockMeshes& meshes, const CutColumns& from, float limit)
      : meshes_(meshes), from_(from), limit_(limit), kept_(vertices_within(meshes, from.values, limit)) {}

  [[nodiscard]] Extent measure() const {
    Extent all;
    for_parts([&](std::int64_t /*block*/, const PartOfCut& part) {
      const ExtentOf extent{part.sides()};
      for (std::int64_t t = 0; t < part.triangles(); ++t) all = AddExtents{}(all, extent(t));
    });
    return all;
  }

  /// As surface::trim::clear_small_pieces().
  SmallPieces clear_small_pieces(std::uint64_t least) {
    RankedBits shared(meshes_.vertices());
    meshes_.mark_shared(shared);
    shared.count();
    JoinedSides pieces = joined(shared);
    SmallPieces small = pieces.count_small(least);
    if (small.cut > 0) {
      flip_small(pieces, 0);
      pieces = joined(shared);
      small.kept = pieces.count_small(least).kept;
    }
    if (small.kept > 0) flip_small(pieces, 1);
    return small;
  }

  /// @param has_crossings  some triangle is split
  BlockCut cut(bool has_crossings) && {
    BlockCut cut{from_, limit_, std::move(kept_), {}, {}, {}, {}};
    cut.kept.count();
    if (has_crossings) find_crossings(cut);
    return cut;
  }

 private:
  template <class Visit>
  void for_parts(const Visit& visit) const {
    for (std::int64_t block = 0; block < meshes_.blocks(); ++block)
      visit(block, PartOfCut(meshes_, block, from_, limit_, kept_));
  }

  [[nodiscard]] JoinedSides joined(const RankedBits& shared) const {
    JoinedSides pieces(shared);
    for_parts([&](std::int64_t /*block*/, const PartOfCut& part) {
      pieces.add(PiecesOfSides(part.sides()), part.vertices());
    });
    return pieces;
  }

  /// Lets the small pieces of one side change to the other.
  void flip_small(JoinedSides& pieces, std::uint8_t from) {
    RankedBits kept = kept_;
    for_parts([&](std::int64_t block, const PartOfCut& part) {
      const PiecesOfSides own(part.sides());
      for (std::size_t v = 0; v < own.piece_of.size(); ++v) {
        const std::int32_t piece = own.piece_of[v];
        if (own.kept[static_cast<std::size_t>(piece)] != from ||
            !pieces.is_small(static_cast<std::size_t>(block), piece))
          continue;
        if (from == 0)
          kept.set(part.vertices()[v]);
        else
          kept.reset(part.vertices()[v]);
      }
    });
    kept_ = std::move(kept);
  }

  /// A vertex on the line.
  struct Crossing {
    std::uint64_t edge = 0;
    Vec3f position{}, normal{};
  };
  struct EdgeOfPart {
    std::uint64_t key = 0;
    std::int32_t low = 0, high = 0;  ///< its ends, in the part
  };

  void find_crossings(BlockCut& cut) const {
    std::vector<Crossing> all;
    for (std::int64_t block = 0; block < meshes_.blocks(); ++block) {
      const PartOfCut part(meshes_, block, from_, limit_, cut.kept);
      const std::vector<EdgeOfPart> edges = crossed_edges(part);
      if (edges.empty()) continue;
      std::vector<Vec3f> normals(part.vertices().size());
      meshes_.read_column(from_.normals, part.vertices(), reinterpret_cast<std::byte*>(normals.data()));
      const SidesView mesh = part.sides();
      for (const EdgeOfPart& edge : edges) {
        const float t = mesh.crossing_upwards(edge.low, edge.high);
        all.push_back({edge.key, on_crossing(mesh.positions[edge.low], mesh.positions[edge.high], t),
                       normal_on_crossing(normals[static_cast<std::size_t>(edge.low)],
                                          normals[static_cast<std::size_t>(edge.high)], t)});
      }
    }
    std::ranges::sort(all, {}, &Crossing::edge);
    for (const Crossing& crossing : all) {
      if (!cut.edges.empty() && cut.edges.back() == crossing.edge) continue;  // of another block, with the same bits
      cut.edges.push_back(crossing.edge);
      cut.positions.push_back(crossing.position);
      cut.normals.push_back(crossing.normal);
    }
  }

  /// By key.
  static std::vector<EdgeOfPart> crossed_edges(const PartOfCut& part) {
    const SidesView mesh = part.sides();
    std::vector<EdgeOfPart> edges;
    const auto add = [&](std::int32_t a, std::int32_t b) {
      edges.push_back({part.edge_key(a, b), std::min(a, b), std::max(a, b)});
    };
    for (std::int64_t t = 0; t < part.triangles(); ++t) {
      const int corners = mesh.kept_corners(t);
      if (corners == 0 || corners == 3) continue;
      const SplitTriangle split = mesh.split(t);
      add(split.alone, split.next);
      add(split.alone, split.last);
    }
    std::ranges::sort(edges, {}, &EdgeOfPart::key);
    const auto is_same = [](const EdgeOfPart& a, const EdgeOfPart& b) { return a.key == b.key; };
    edges.erase(std::unique(edges.begin(), edges.end(), is_same), edges.end());
    return edges;
  }

  const BlockMeshes& meshes_;
  CutColumns from_;
  float limit_;
  RankedBits kept_;
};

}  // namespace

BlockCut BlockCut::of_nothing(const BlockMeshes& meshes, const CutColumns& from) {
  BlockCut cut;
  cut.from = from;
  cut.kept = RankedBits(meshes.vertices());
  for (std::int64_t v = 0; v < meshes.vertices(); ++v) cut.kept.set(v);
  cut.kept.count();
  return cut;
}

PartOfCut::PartOfCut(const BlockMeshes& meshes, std::int64_t block, const CutColumns& from, float limit,
                     const RankedBits& kept)
    : mesh_(meshes.read_block(block)),
      positions_(mesh_.vertices.size()),
      values_(mesh_.vertices.size()),
      kept_(mesh_.vertices.size()),
      limit_(limit) {
  meshes.read_column(from.positions, mesh_.vertices, reinterpret_cast<std::byte*>(positions_.data()));
  meshes.read_column(from.values, mesh_.vertices, reinterpret_cast<std::byte*>(values_.data()));
  std::ranges::transform(mesh_.vertices, kept_.begin(),
                         [&](std::int64_t v) { return static_cast<std::uint8_t>(kept.at(v) ? 1 : 0); });
}

SidesView PartOfCut::sides() const {
  return {{positions_.data(), std::ssize(positions_)},
          {mesh_.triangles.data(), std::ssize(mesh_.triangles)},
          {values_.data(), std::ssize(values_)},
          limit_,
          {kept_.data(), std::ssize(kept_)}};
}

std::uint64_t PartOfCut::edge_key(std::int32_t a, std::int32_t b) const {
  const auto number = [&](std::int32_t v) {
    return static_cast<std::uint32_t>(mesh_.vertices[static_cast<std::size_t>(v)]);
  };
  return surface::trim::edge_key(number(a), number(b));
}

BlockCut find_cut(const BlockMeshes& meshes, const CutColumns& from, const surface::TrimOptions& options,
                  surface::TrimCounts& counts) {
  Cutter cutter(meshes, from, options.limit);
  Extent extent = cutter.measure();
  const std::uint64_t least = area_units(options.island_ratio * extent.area.value(kAreaFraction));
  if (least > 0) {
    const SmallPieces small = cutter.clear_small_pieces(least);
    counts.islands_removed = small.kept;
    counts.holes_filled = small.cut;
    if (small.kept > 0 || small.cut > 0) extent = cutter.measure();
  }
  counts.area_before = extent.area.value(kAreaFraction);
  counts.area_kept = extent.kept_area.value(kAreaFraction);
  counts.triangles_before = meshes.triangles();
  counts.triangles_removed = meshes.triangles() - extent.whole - extent.split;
  counts.triangles_split = extent.split;
  return std::move(cutter).cut(extent.split > 0);
}

}  // namespace pointskin::scale
