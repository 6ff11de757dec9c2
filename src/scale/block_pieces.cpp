#include "scale/block_pieces.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <numeric>

#include "exec/disjoint_sets.hpp"

namespace pointskin::scale {

using surface::PieceExtent;

PiecesOfPart find_pieces(const PartOfMesh& part) {
  const std::size_t vertices = part.positions.size();
  std::vector<std::int32_t> parents(vertices);
  std::iota(parents.begin(), parents.end(), 0);
  const exec::DisjointSets sets{{parents.data(), std::ssize(parents)}};
  PiecesOfPart pieces;
  pieces.piece_of.assign(vertices, -1);
  constexpr std::int32_t kTouched = -2;
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    if (part.is_own[t] == 0) continue;
    const Triangle& corners = part.triangles[t];
    sets.unite(corners[0], corners[1]);
    sets.unite(corners[1], corners[2]);
    for (const std::int32_t v : corners) pieces.piece_of[static_cast<std::size_t>(v)] = kTouched;
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    const bool is_own = v - part.first_own < part.own;
    std::int32_t& piece = pieces.piece_of[v];
    if (piece != kTouched && !is_own) continue;
    const auto root = static_cast<std::size_t>(sets.root(static_cast<std::int32_t>(v)));  // at most v
    if (root == v) {
      piece = static_cast<std::int32_t>(pieces.extents.size());
      pieces.extents.emplace_back();
      pieces.first_own_vertex.push_back(PiecesOfPart::kNone);
    } else {
      piece = pieces.piece_of[root];
    }
    std::int64_t& first = pieces.first_own_vertex[static_cast<std::size_t>(piece)];
    if (is_own) first = std::min(first, static_cast<std::int64_t>(v));
  }
  const surface::trim::SidesView mesh{{part.positions.data(), std::ssize(part.positions)},
                                      {part.triangles.data(), std::ssize(part.triangles)},
                                      {},
                                      0,
                                      {}};
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    if (part.is_own[t] == 0) continue;
    const auto corner = static_cast<std::size_t>(part.triangles[t][0]);
    PieceExtent& extent = pieces.extents[static_cast<std::size_t>(pieces.piece_of[corner])];
    const double area = mesh.area(static_cast<std::int64_t>(t));
    extent.add_triangle(area);
    if (!part.density.empty()) extent.add_samples(area, part.density[corner]);
  }
  return pieces;
}

namespace {

constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

[[noreturn]] void throw_too_many() {
  throw Error(ErrorCode::over_limit, "the mesh of the blocks has more than 2^31 pieces");
}

}  // namespace

std::int32_t BlockPieces::join(const Team& team, std::int64_t vertices_before) {
  for (std::int64_t& first : first_vertices_)
    if (first != PiecesOfPart::kNone) first += vertices_before;
  const std::vector<std::int64_t> sizes = team.gather_all(std::vector<std::int64_t>{size()});
  if (std::accumulate(sizes.begin(), sizes.end(), std::int64_t{0}) > kMost) throw_too_many();
  extents_ = team.gather_all(std::move(extents_));
  first_vertices_ = team.gather_all(std::move(first_vertices_));
  parents_.resize(extents_.size());
  std::iota(parents_.begin(), parents_.end(), 0);
  return static_cast<std::int32_t>(std::accumulate(sizes.begin(), sizes.begin() + team.rank(), std::int64_t{0}));
}

std::int32_t BlockPieces::add(const PieceExtent& extent, std::int64_t first_vertex) {
  if (size() == kMost) throw_too_many();
  parents_.push_back(size());
  extents_.push_back(extent);
  first_vertices_.push_back(first_vertex);
  return size() - 1;
}

void BlockPieces::unite(std::int32_t a, std::int32_t b) {
  exec::DisjointSets{{parents_.data(), std::ssize(parents_)}}.unite(a, b);
}

void BlockPieces::reaches(std::int32_t piece, std::int64_t vertex) {
  std::int64_t& first = first_vertices_[static_cast<std::size_t>(piece)];
  first = std::min(first, vertex);
}

surface::PieceCounts BlockPieces::choose(const surface::PieceOptions& options) {
  const exec::DisjointSets sets{{parents_.data(), std::ssize(parents_)}};
  const auto at_root = [&](std::size_t p) { return static_cast<std::size_t>(sets.root(static_cast<std::int32_t>(p))); };
  for (std::size_t p = 0; p < parents_.size(); ++p) {
    const std::size_t root = at_root(p);
    if (root == p) continue;
    extents_[root].add(extents_[p]);
    first_vertices_[root] = std::min(first_vertices_[root], first_vertices_[p]);
  }
  const auto is_piece = [&](std::size_t p) { return at_root(p) == p && extents_[p].triangles > 0; };
  surface::WholeOfPieces whole;
  for (std::size_t p = 0; p < parents_.size(); ++p)
    if (is_piece(p)) whole = surface::AddWholes{}(whole, {extents_[p].area, extents_[p].area, 1, first_vertices_[p]});
  const surface::PieceRule rule = surface::rule_of(options, whole);
  surface::PieceCounts counts;
  counts.pieces = whole.pieces;
  stays_.assign(parents_.size(), false);
  for (std::size_t p = 0; p < parents_.size(); ++p) {
    const std::size_t root = at_root(p);  // of which was settled before
    stays_[p] = root < p ? stays_[root] : is_piece(p) && rule.stays(first_vertices_[p], extents_[p]);
    if (!is_piece(p) || stays_[p]) continue;
    ++counts.pieces_removed;
    counts.triangles_removed += static_cast<std::int64_t>(extents_[p].triangles);
  }
  return counts;
}

}  // namespace pointskin::scale
