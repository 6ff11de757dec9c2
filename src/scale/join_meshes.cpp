#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "scale/block_meshes.hpp"

// BlockMeshes::finish of what several ranks have added.
namespace pointskin::scale {

void BlockMeshes::join() {
  const Team& team = setup_.team;
  const auto before = [&](std::int64_t own) {
    const std::vector<std::int64_t> all = team.gather_all(std::vector<std::int64_t>{own});
    return std::accumulate(all.begin(), all.begin() + team.rank(), std::int64_t{0});
  };
  const std::int64_t vertices = before(inner_), blocks = before(std::ssize(blocks_));
  for (Block& block : blocks_) block.first += vertices;
  for (Cell& cell : cells_) cell.first += vertices;
  for (Chunk& chunk : chunks_) chunk.block += blocks;
  if (setup_.pieces) join_piece_numbers(vertices);
  join_tables();
  std::vector<std::unique_ptr<Spool>*> spools;
  for (Block& block : blocks_) spools.push_back(&block.spool);
  team.share_spools(setup_.folder, spools);
}

void BlockMeshes::join_piece_numbers(std::int64_t vertices_before) {
  constexpr std::int64_t kAtOnce = 64 << 10;
  const std::int32_t before = pieces_.join(setup_.team, vertices_before);
  std::vector<std::int32_t> pieces;
  for (Block& block : blocks_) {
    for (std::int32_t& piece : block.pieces_of_others)
      if (piece >= 0) piece += before;
    const std::int64_t column = block.count * column_begins_[piece_column()];
    for (std::int64_t first = 0; first < block.count; first += std::ssize(pieces)) {
      pieces.resize(static_cast<std::size_t>(std::min(kAtOnce, block.count - first)));
      const std::int64_t at = column + first * std::int64_t{sizeof(std::int32_t)};
      const std::int64_t bytes = std::ssize(pieces) * std::int64_t{sizeof(std::int32_t)};
      block.spool->read(at, pieces.data(), bytes);
      for (std::int32_t& piece : pieces) piece += before;
      block.spool->write(at, pieces.data(), bytes);
    }
  }
}

void BlockMeshes::join_tables() {
  struct Head {
    std::int64_t first, count, triangles, others, pieces_of_others;
  };
  const Team& team = setup_.team;
  std::vector<Head> heads;
  std::vector<Reference> others;
  std::vector<std::int32_t> pieces;
  for (const Block& block : blocks_) {
    heads.push_back(
        {block.first, block.count, block.triangles, std::ssize(block.others), std::ssize(block.pieces_of_others)});
    others.insert(others.end(), block.others.begin(), block.others.end());
    pieces.insert(pieces.end(), block.pieces_of_others.begin(), block.pieces_of_others.end());
  }
  std::vector<Block> own = std::move(blocks_);
  blocks_.clear();
  const std::vector<std::vector<Head>> all = team.gather(std::move(heads));
  others = team.gather_all(std::move(others));
  pieces = team.gather_all(std::move(pieces));
  auto other = others.begin();
  auto piece = pieces.begin();
  for (std::size_t rank = 0; rank < all.size(); ++rank)
    for (std::size_t i = 0; i < all[rank].size(); ++i) {
      const Head& head = all[rank][i];
      Block block;
      block.first = head.first;
      block.count = head.count;
      block.triangles = head.triangles;
      block.others.assign(other, other + head.others);
      block.pieces_of_others.assign(piece, piece + head.pieces_of_others);
      if (static_cast<int>(rank) == team.rank()) block.spool = std::move(own[i].spool);
      blocks_.push_back(std::move(block));
      other += head.others;
      piece += head.pieces_of_others;
    }
  cells_ = team.gather_all(std::move(cells_));
  chunks_ = team.gather_all(std::move(chunks_));
  outer_.keys = team.gather_all(std::move(outer_.keys));
  outer_.values = team.gather_all(std::move(outer_.values));
  inner_ = team.reduce(inner_, std::plus<>{});
  triangles_ = team.reduce(triangles_, std::plus<>{});
}

}  // namespace pointskin::scale
