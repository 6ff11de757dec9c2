// The connected pieces of a mesh of blocks: those of the triangles that every block owns, joined where blocks share vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <pointskin/vector.hpp>

#include "scale/team.hpp"
#include "surface/piece_rule.hpp"
#include "surface/pieces.hpp"

namespace pointskin::scale {

/// The mesh of a block and its ring, as far as pieces are concerned.
struct PartOfMesh {
  std::span<const Vec3f> positions;  ///< (v) in the unit cube
  std::span<const Triangle> triangles;
  std::span<const std::uint8_t> is_own;  ///< (t) 1: counted here
  std::span<const float> density;        ///< (v) as surface::PieceOptions::density, or empty
  std::size_t first_own = 0, own = 0;    ///< vertices that get a piece in any case
};

/// Pieces of the own triangles alone.
struct PiecesOfPart {
  std::vector<std::int32_t> piece_of;          ///< (v) or -1 of vertices of neither an own triangle nor the block
  std::vector<surface::PieceExtent> extents;   ///< (pieces)
  std::vector<std::int64_t> first_own_vertex;  ///< (pieces) or kNone
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
};

/// Pieces are numbered by their first vertices here. Deterministic: sums are in integers.
/// O(v + t), 8 bytes a vertex.
PiecesOfPart find_pieces(const PartOfMesh& part);

/// Pieces of all parts, by numbers in the order in which they are added.
class BlockPieces {
 public:
  /// @param first_vertex  number in the whole mesh, or PiecesOfPart::kNone
  /// @returns the number of the piece
  /// @throws Error over_limit if there are more than 2^31
  std::int32_t add(const surface::PieceExtent& extent, std::int64_t first_vertex);

  [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(parents_.size()); }

  /// Adds those of other ranks, which come before this rank's or after them, as the ranks do; before any are united. Collective.
  /// @param vertices_before  vertices of the ranks before
  /// @returns how many come before this rank's
  /// @throws Error as add()
  std::int32_t join(const Team& team, std::int64_t vertices_before);

  /// Makes one piece of two.
  void unite(std::int32_t a, std::int32_t b);

  /// A piece has a vertex in another block.
  void reaches(std::int32_t piece, std::int64_t vertex);

  /// Settles which pieces stay, as surface::keep_pieces() does; once all are there and united. Called once.
  /// O(pieces), whatever the order in which parts were added and united
  surface::PieceCounts choose(const surface::PieceOptions& options);

  /// After choose().
  [[nodiscard]] bool stays(std::int32_t piece) const { return stays_[static_cast<std::size_t>(piece)]; }

 private:
  std::vector<std::int32_t> parents_;
  std::vector<surface::PieceExtent> extents_;
  std::vector<std::int64_t> first_vertices_;
  std::vector<bool> stays_;
};

}  // namespace pointskin::scale
