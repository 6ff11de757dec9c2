// The mesh of blocks cut along an iso-line of values at its vertices: where surface::trim_surface() cuts that of the whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pointskin/vector.hpp>

#include "scale/block_meshes.hpp"
#include "scale/ranked_bits.hpp"
#include "surface/trim.hpp"
#include "surface/trim_pieces.hpp"

namespace pointskin::scale {

/// Columns of BlockMeshes that a cut needs.
struct CutColumns {
  std::size_t positions = 0, normals = 1;
  std::size_t values = 2;  ///< float, finite: what is above the limit is cut away
};

/// Where a mesh is cut.
struct BlockCut {
  CutColumns from;
  float limit = 0;
  RankedBits kept{0};                          ///< (v) vertices that stay
  std::vector<std::uint64_t> edges;            ///< (e) crossed: PartOfCut::edge_key(), ascending
  std::vector<Vec3f> positions;                ///< (e) of the vertices on them, which follow those that stay
  std::vector<Vec3f> normals;                  ///< (e)
  std::vector<std::vector<std::byte>> others;  ///< (columns, e) of other columns; empty ones are 0

  /// Leaves all as it is.
  static BlockCut of_nothing(const BlockMeshes& meshes, const CutColumns& from);
};

/// The triangles of one block, with what a cut needs of their vertices.
class PartOfCut {
 public:
  /// @throws Error as BlockMeshes::read_block
  PartOfCut(const BlockMeshes& meshes, std::int64_t block, const CutColumns& from, float limit, const RankedBits& kept);

  [[nodiscard]] surface::trim::SidesView sides() const;
  /// (v) numbers in the whole, ascending, so that ends of edges have the same order as there.
  [[nodiscard]] const std::vector<std::int64_t>& vertices() const { return mesh_.vertices; }
  [[nodiscard]] std::int64_t triangles() const { return std::ssize(mesh_.triangles); }
  /// Key of an edge of two vertices of the part, by their numbers in the whole.
  [[nodiscard]] std::uint64_t edge_key(std::int32_t a, std::int32_t b) const;

 private:
  BlockMeshes::MeshOfBlock mesh_;
  std::vector<Vec3f> positions_;
  std::vector<float> values_;
  std::vector<std::uint8_t> kept_;
  float limit_;
};

/// Settles what stays: sides, small pieces of either side, and the vertices on the line between them.
/// @param meshes  after finish()
/// @param counts  receives what surface::trim_surface() counts
/// @throws Error as BlockMeshes::read_block
/// Reads all blocks twice, and up to five times more where pieces may be too small. In memory: a block with its vertices, 12 bytes
/// a triangle and 61 a vertex; a byte for 2 vertices of the whole; 64 for an edge that is crossed. Deterministic: sums are exact.
BlockCut find_cut(const BlockMeshes& meshes, const CutColumns& from, const surface::TrimOptions& options,
                  surface::TrimCounts& counts);

}  // namespace pointskin::scale
