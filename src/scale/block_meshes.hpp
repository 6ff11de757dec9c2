// The mesh of all blocks of a cloud, from the meshes of single ones: the vertices and triangles of the whole, in its order
// and with its numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <pointskin/vector.hpp>

#include "exec/cpu.hpp"
#include "scale/block_pieces.hpp"
#include "scale/ranked_bits.hpp"
#include "scale/spool.hpp"
#include "scale/team.hpp"
#include "surface/pieces.hpp"

namespace pointskin::scale {

/// What is extracted from a block and its ring. Keys are Morton keys of cells of the finest level.
struct BlockMesh {
  std::uint64_t begin = 0, end = 0;     ///< the block's own cells: keys begin..end - 1
  std::span<const std::uint64_t> keys;  ///< (v) of vertices, ascending: the corner that a vertex starts at
  /// Arrays over the vertices, positions or normals or values of an attribute, in the order of BlockMeshes' `columns`.
  std::span<const std::byte* const> columns;
  std::span<const Triangle> triangles;     ///< (t) numbers of the block's vertices
  std::span<const std::uint64_t> cells;    ///< (t) the first of the finest cells in the cell that a triangle lies in
  std::span<const std::uint8_t> segments;  ///< (t) ascending; in one segment, triangles are in the order of their cells
  std::span<const float> density{};        ///< (v) as surface::PieceOptions::density, or empty

  [[nodiscard]] bool owns(std::uint64_t cell) const { return cell >= begin && cell < end; }
};

struct BlockCut;

/// Takes own vertices and triangles of block after block. What lies in the ring is not kept, but tells the numbers of
/// vertices in other blocks: by the cell of a coarser level that they lie in, and their place among the vertices of this
/// cell. So no block waits for another one.
///
/// In the order of the whole mesh, vertices are sorted by key, and those on the upper faces of the cube, which start at
/// corners beyond the last cell of an axis, come last; triangles are sorted by segment and cell.
class BlockMeshes {
 public:
  using Indices = std::array<std::uint32_t, 3>;

  struct Setup {
    std::string folder;                 ///< for temporary data: the mesh once
    int depth = 0;                      ///< finest level
    int cell_level = 0;                 ///< of the cells by which vertices of other blocks are found
    std::vector<std::int64_t> columns;  ///< bytes that a vertex has in each
    bool pieces = false;                ///< finds pieces, for keep_pieces(); positions are the first column
    Team team{};                        ///< of ranks of which each adds some blocks, those of the first one first
  };

  explicit BlockMeshes(Setup setup);

  /// Blocks come in ascending order of their cells. Every vertex of a triangle that lies in an own cell must be there, and
  /// all vertices of the cells of `cell_level` that hold one; of those on the upper faces of the cube, all of its corner.
  /// @throws Error output_not_written, interrupted
  /// O(v + t), 5 bytes a vertex of scratch, and 10 with pieces
  void add(exec::Cpu& ex, const BlockMesh& block);

  /// When all blocks are there. All ranks then have all of the mesh. Collective.
  /// @throws Error over_limit if there are more than 2^32 vertices; internal if a vertex that a triangle needs is in no block
  /// O(blocks + border vertices log cells)
  void finish();

  /// Leaves what a cut leaves, as surface::trim_surface() does; after finish(), once. @see block_trim.hpp
  /// @param supports  column with the density of BlockMesh, if there are pieces and it is needed
  /// @throws Error over_limit, output_not_written, interrupted
  /// Writes all blocks anew, while the old ones are there still. One block is in memory: 24 bytes a triangle, 64 a vertex.
  void cut(exec::Cpu& ex, const BlockCut& cut, bool pieces, std::optional<std::size_t> supports);

  /// Leaves out pieces, as surface::keep_pieces() does; after finish(), once, if Setup::pieces is true or cut() has found them. The
  /// options' density is that of the blocks.
  /// @throws Error output_not_written, interrupted
  /// Reads the pieces of all vertices, and writes anew the blocks that lose some. A byte for 5 vertices of scratch.
  surface::PieceCounts keep_pieces(const surface::PieceOptions& options);

  [[nodiscard]] std::int64_t vertices() const { return inner_ + outer_.size(); }
  [[nodiscard]] std::int64_t triangles() const { return triangles_; }
  [[nodiscard]] std::int64_t columns() const { return std::ssize(setup_.columns) - (setup_.pieces ? 1 : 0); }

  [[nodiscard]] std::int64_t column_bytes(std::size_t column) const { return setup_.columns[column]; }

  /// Column `column` of vertices first .. first + count - 1; for many threads at once, after finish().
  /// @throws Error output_not_written if the disk fails, interrupted
  void read_column(std::size_t column, std::int64_t first, std::int64_t count, std::byte* out) const;
  /// The same of some vertices, by their numbers, which ascend; those that are near each other are read at once.
  void read_column(std::size_t column, std::span<const std::int64_t> vertices, std::byte* out) const;

  /// Sets the bits of vertices that triangles of several blocks may have; after finish().
  void mark_shared(RankedBits& vertices) const;

  [[nodiscard]] std::int64_t blocks() const { return std::ssize(blocks_); }
  [[nodiscard]] std::int64_t triangles_of(std::int64_t block) const {
    return blocks_[static_cast<std::size_t>(block)].triangles;
  }

  /// The triangles of one block, and the vertices that they have.
  struct MeshOfBlock {
    std::vector<std::int64_t> vertices;  ///< (v) their numbers in the whole, ascending
    std::vector<Triangle> triangles;     ///< (t) numbers in `vertices`, in the order of the whole
  };
  /// After finish(). All of it is in memory: 12 bytes a triangle and 16 a vertex.
  /// @throws Error output_not_written if the disk fails, interrupted
  [[nodiscard]] MeshOfBlock read_block(std::int64_t block) const;

  /// Triangles first .. first + count - 1; for many threads at once, after finish().
  /// @throws Error output_not_written if the disk fails, interrupted
  void read_triangles(std::int64_t first, std::int64_t count, Indices* out) const;

 private:
  /// A vertex on an upper face of the cube, or in another block: by where it starts or by its cell, and its place among
  /// those of equal keys or cells.
  struct Reference {
    std::uint64_t key = 0;  ///< with kOuter the key of its corner, else that of its cell
    std::int64_t place = 0;
  };
  static constexpr std::uint64_t kOuter = std::uint64_t{1} << 63;
  static constexpr std::int64_t kIndexBytes = sizeof(Indices);

  /// The vertices of a cell of `cell_level`.
  struct Cell {
    std::uint64_t key = 0;
    std::int64_t first = 0, count = 0;
  };
  /// Vertices that follow the inner ones: on upper faces of the cube, by key after finish(), and then those that a cut made.
  struct Outer {
    std::vector<std::uint64_t> keys;
    std::vector<std::byte> values;  ///< of all columns, vertex after vertex
    [[nodiscard]] std::int64_t size() const { return std::ssize(keys); }
  };
  /// Triangles that follow each other both in the whole mesh and in a block.
  struct Chunk {
    int segment = 0;
    std::int64_t block = 0;
    std::int64_t first = 0;   ///< in the block
    std::int64_t before = 0;  ///< triangles of the whole before it
    std::int64_t count = 0;
  };
  struct Block {
    std::int64_t first = 0, count = 0;  ///< own inner vertices in the whole
    std::unique_ptr<Spool> spool;       ///< own inner vertices column after column, then triangles
    std::int64_t triangles = 0;
    std::vector<Reference> others;       ///< vertices that triangles number after the own inner ones
    std::vector<std::uint32_t> numbers;  ///< of these, after finish()
    std::vector<std::int32_t> pieces_of_others;
  };

  [[nodiscard]] bool is_outer(std::uint64_t key) const { return key >> 3 * setup_.depth != 0; }
  [[nodiscard]] std::uint64_t cell_of(std::uint64_t key) const { return key >> 3 * (setup_.depth - setup_.cell_level); }
  /// Key of the cell inside the cube beside which a corner on an upper face lies.
  [[nodiscard]] std::uint64_t owner_of_outer(std::uint64_t key) const;
  /// @param keys  of all vertices of a block
  [[nodiscard]] Reference reference_to(std::span<const std::uint64_t> keys, std::size_t vertex) const;
  [[nodiscard]] std::uint32_t number_of(const Reference& vertex) const;

  /// What the other ranks have added.
  void join();
  void join_tables();
  /// Numbers the pieces of own blocks after those of the ranks before.
  void join_piece_numbers(std::int64_t vertices_before);
  void count_vertices(const BlockMesh& from, std::size_t first, Block& block);
  void add_outer(const BlockMesh& from);
  void sort_outer();
  [[nodiscard]] std::byte* outer_values(std::int64_t i) { return outer_.values.data() + i * column_begins_.back(); }
  [[nodiscard]] const std::byte* outer_values(std::int64_t i) const {
    return outer_.values.data() + i * column_begins_.back();
  }
  /// @returns own triangles
  std::int64_t count_triangles(const BlockMesh& from);
  /// @param pieces  (v) or empty
  void write_vertices(exec::Cpu& ex, const BlockMesh& from, std::size_t first, std::span<const std::int32_t> pieces,
                      const Block& block) const;
  void write_triangles(exec::Cpu& ex, const BlockMesh& from, std::size_t first, std::span<const std::int32_t> pieces,
                       Block& block) const;
  void place_chunks();
  void read_inner(std::size_t column, std::int64_t first, std::int64_t count, std::byte* out) const;

  /// Where the triangles begin in a block's spool.
  [[nodiscard]] std::int64_t triangles_at(std::int64_t vertices) const { return vertices * column_begins_.back(); }
  /// The last column, with pieces.
  [[nodiscard]] std::size_t piece_column() const { return setup_.columns.size() - 1; }
  /// Adds the pieces of a block. @returns (v) their numbers among those of all blocks, or -1
  [[nodiscard]] std::vector<std::int32_t> add_pieces(const BlockMesh& from, std::size_t first, const Block& block);
  /// Adds them to those of all blocks, and renumbers them.
  /// @param first  vertex of the part that is the block's first own one
  void keep_found(PiecesOfPart& pieces, const Block& block, std::size_t first);
  void join_pieces();
  /// What cut() makes of one block.
  struct BlockThatIsCut;
  [[nodiscard]] BlockThatIsCut cut_block(exec::Cpu& ex, std::int64_t number, const BlockCut& cut, bool pieces,
                                         std::optional<std::size_t> supports);
  void cut_outer(const BlockCut& cut, bool pieces);
  [[nodiscard]] RankedBits vertices_that_stay() const;
  void leave_out_outer(const RankedBits& stays);
  /// Of one block: what does not stay.
  void leave_out(std::size_t number, const RankedBits& stays);
  /// @param count  own vertices that stay
  void write_columns_that_stay(const Block& block, const RankedBits& stays, std::int64_t count, const Spool& out) const;
  /// @param other_of  (block.numbers) places of those that stay among each other
  void write_triangles_that_stay(std::size_t number, const RankedBits& stays, std::int64_t count,
                                 const std::vector<std::uint32_t>& other_of, const Spool& out);

  Setup setup_;
  std::vector<std::int64_t> column_begins_;  ///< bytes of the columns before each
  std::vector<Block> blocks_;
  std::vector<Cell> cells_;  ///< ascending
  Outer outer_;
  std::vector<Chunk> chunks_;      ///< in the order of the whole after finish()
  BlockPieces pieces_;             ///< of all blocks, and after join_pieces() one for each outer vertex
  std::int32_t outer_pieces_ = 0;  ///< the first of these
  std::int64_t inner_ = 0;
  std::int64_t triangles_ = 0;
};

}  // namespace pointskin::scale
