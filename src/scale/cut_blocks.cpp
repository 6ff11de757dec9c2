#include <pointskin/error.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scale/block_meshes.hpp"
#include "scale/block_trim.hpp"
#include "surface/split_triangle.hpp"

// BlockMeshes::cut and what it is made of.
namespace pointskin::scale {
namespace {

using surface::trim::place_of_edge;

/// Numbers in the mesh that is left.
struct NumbersAfter {
  const BlockCut& cut;
  const PartOfCut& part;

  [[nodiscard]] std::int32_t kept(std::int32_t v) const {
    return as_index(cut.kept.before(part.vertices()[static_cast<std::size_t>(v)]));
  }
  [[nodiscard]] std::int32_t on_edge(std::int32_t a, std::int32_t b) const {
    return as_index(cut.kept.ones() + place_of_edge({cut.edges.data(), std::ssize(cut.edges)}, part.edge_key(a, b)));
  }
  /// They may be beyond 2^31.
  static std::int32_t as_index(std::int64_t number) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(number));
  }
};

}  // namespace

struct BlockMeshes::BlockThatIsCut {
  Block block;
  std::vector<std::int64_t> counts;  ///< triangles that are left of each of its chunks
};

void BlockMeshes::cut(exec::Cpu& ex, const BlockCut& cut, bool pieces, std::optional<std::size_t> supports) {
  const std::int64_t stay = cut.kept.ones();
  if (stay + std::ssize(cut.edges) > std::int64_t{1} << 32)
    throw Error(ErrorCode::over_limit, "the mesh has " + std::to_string(stay + std::ssize(cut.edges)) +
                                           " vertices where it is cut, more than 32-bit indices reach");
  pieces_ = {};
  std::vector<Block> blocks;
  std::vector<std::vector<std::int64_t>> counts;
  for (std::int64_t number = 0; number < this->blocks(); ++number) {
    BlockThatIsCut now = cut_block(ex, number, cut, pieces, supports);
    blocks.push_back(std::move(now.block));
    counts.push_back(std::move(now.counts));
  }
  std::vector<std::size_t> next(counts.size(), 0);  // chunk of a block
  for (Chunk& chunk : chunks_) {
    const auto block = static_cast<std::size_t>(chunk.block);
    const std::vector<std::int64_t>& left = counts[block];
    chunk.first = 0;
    for (std::size_t i = 0; i < next[block]; ++i) chunk.first += left[i];
    chunk.count = left[next[block]++];
  }
  std::erase_if(chunks_, [](const Chunk& chunk) { return chunk.count == 0; });
  blocks_ = std::move(blocks);
  cut_outer(cut, pieces);
  inner_ = cut.kept.before(inner_);
  setup_.pieces = pieces;
  if (pieces) {
    setup_.columns.push_back(sizeof(std::int32_t));
    column_begins_.push_back(column_begins_.back() + setup_.columns.back());
  }
  place_chunks();
}

void BlockMeshes::cut_outer(const BlockCut& cut, bool pieces) {
  const std::int64_t before = column_begins_.back();
  const std::int64_t after = before + (pieces ? std::int64_t{sizeof(std::int32_t)} : 0);
  Outer outer;
  const auto add = [&](std::uint64_t key) {
    outer.keys.push_back(key);
    outer.values.resize(static_cast<std::size_t>(outer.size() * after));
    return outer.values.data() + (outer.size() - 1) * after;
  };
  for (std::int64_t i = 0; i < outer_.size(); ++i)
    if (cut.kept.at(inner_ + i))
      std::memcpy(add(outer_.keys[static_cast<std::size_t>(i)]), outer_values(i), static_cast<std::size_t>(before));
  for (std::size_t edge = 0; edge < cut.edges.size(); ++edge) {
    std::byte* const to = add(0);
    std::memcpy(to + column_begins_[cut.from.positions], &cut.positions[edge], sizeof(Vec3f));
    std::memcpy(to + column_begins_[cut.from.normals], &cut.normals[edge], sizeof(Vec3f));
    for (std::size_t c = 0; c < cut.others.size(); ++c)
      if (!cut.others[c].empty()) {
        const auto bytes = static_cast<std::size_t>(setup_.columns[c]);
        std::memcpy(to + column_begins_[c], &cut.others[c][edge * bytes], bytes);
      }
  }
  outer_ = std::move(outer);
}

BlockMeshes::BlockThatIsCut BlockMeshes::cut_block(exec::Cpu& ex, std::int64_t number, const BlockCut& cut, bool pieces,
                                                   std::optional<std::size_t> supports) {
  const Block& block = blocks_[static_cast<std::size_t>(number)];
  BlockThatIsCut now;
  now.block.first = cut.kept.before(block.first);
  now.block.count = cut.kept.before(block.first + block.count) - now.block.first;
  const PartOfCut part(*this, number, cut.from, cut.limit, cut.kept);
  const surface::trim::SidesView mesh = part.sides();
  const NumbersAfter ids{cut, part};

  std::vector<Triangle> triangles;  // by numbers in the whole, and then in the block
  std::int64_t t = 0;
  for (const Chunk& chunk : chunks_) {
    if (chunk.block != number) continue;
    const auto before = std::ssize(triangles);
    for (const std::int64_t end = t + chunk.count; t < end; ++t) {
      Triangle left[2];
      const int count = surface::trim::split_triangle(mesh, t, ids, left);
      triangles.insert(triangles.end(), left, left + count);
    }
    now.counts.push_back(std::ssize(triangles) - before);
  }
  now.block.triangles = std::ssize(triangles);

  const std::int64_t own = now.block.count;
  const auto own_place = [&](std::uint32_t v) { return static_cast<std::int64_t>(v) - now.block.first; };
  const auto is_own = [&](std::uint32_t v) { return own_place(v) >= 0 && own_place(v) < own; };
  std::vector<std::uint32_t>& others = now.block.numbers;
  for (const Triangle& corners : triangles)
    for (const std::int32_t corner : corners)
      if (const auto v = static_cast<std::uint32_t>(corner); !is_own(v)) others.push_back(v);
  std::ranges::sort(others);
  others.erase(std::unique(others.begin(), others.end()), others.end());
  const auto place = [&](std::uint32_t v) {
    return is_own(v) ? own_place(v) : own + (std::ranges::lower_bound(others, v) - others.begin());
  };
  for (Triangle& corners : triangles)
    for (std::int32_t& corner : corners) corner = static_cast<std::int32_t>(place(static_cast<std::uint32_t>(corner)));

  const std::int64_t piece_at = own * column_begins_.back();
  const std::int64_t triangles_at = piece_at + (pieces ? own * std::int64_t{sizeof(std::int32_t)} : 0);
  now.block.spool = std::make_unique<Spool>(setup_.folder, triangles_at + now.block.triangles * kIndexBytes);
  write_columns_that_stay(block, cut.kept, own, *now.block.spool);
  now.block.spool->write(ex, triangles_at, triangles.data(), now.block.triangles * kIndexBytes);
  if (!pieces) return now;

  // Of vertices that the triangles have; the others' places have no area.
  std::vector<Vec3f> positions(static_cast<std::size_t>(own) + others.size());
  std::vector<float> density(supports ? positions.size() : 0);
  std::vector<float> densities(supports ? part.vertices().size() : 0);
  if (supports) read_column(*supports, part.vertices(), reinterpret_cast<std::byte*>(densities.data()));
  for (std::size_t v = 0; v < part.vertices().size(); ++v) {
    if (!cut.kept.at(part.vertices()[v])) continue;
    const auto after = static_cast<std::uint32_t>(cut.kept.before(part.vertices()[v]));
    const auto to = static_cast<std::size_t>(place(after));
    if (!is_own(after) && (to == positions.size() || others[to - static_cast<std::size_t>(own)] != after)) continue;
    positions[to] = mesh.positions[static_cast<std::int64_t>(v)];
    if (supports) density[to] = densities[v];
  }
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (others[i] < cut.kept.ones()) continue;
    const auto edge = static_cast<std::size_t>(others[i] - cut.kept.ones());
    positions[static_cast<std::size_t>(own) + i] = cut.positions[edge];
    if (supports)
      std::memcpy(&density[static_cast<std::size_t>(own) + i], &cut.others[*supports][edge * sizeof(float)],
                  sizeof(float));
  }
  const std::vector<std::uint8_t> all_own(triangles.size(), 1);
  PiecesOfPart found = find_pieces({positions, triangles, all_own, density, 0, static_cast<std::size_t>(own)});
  keep_found(found, now.block, 0);
  now.block.spool->write(ex, piece_at, found.piece_of.data(), own * std::int64_t{sizeof(std::int32_t)});
  now.block.pieces_of_others.assign(found.piece_of.begin() + own, found.piece_of.end());
  return now;
}

}  // namespace pointskin::scale
