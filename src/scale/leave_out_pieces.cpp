#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "scale/block_meshes.hpp"

// BlockMeshes::keep_pieces and what it is made of.
namespace pointskin::scale {
namespace {

constexpr std::int64_t kElementsAtOnce = 64 << 10;  // vertices or triangles

}  // namespace

surface::PieceCounts BlockMeshes::keep_pieces(const surface::PieceOptions& options) {
  join_pieces();
  const surface::PieceCounts counts = pieces_.choose(options);
  if (counts.pieces_removed == 0) return counts;
  const RankedBits stays = vertices_that_stay();
  for (std::size_t block = 0; block < blocks_.size(); ++block) leave_out(block, stays);
  const std::int64_t before = inner_;
  leave_out_outer(stays);
  inner_ = stays.before(before);
  std::erase_if(chunks_, [](const Chunk& chunk) { return chunk.count == 0; });
  place_chunks();
  return counts;
}

void BlockMeshes::leave_out_outer(const RankedBits& stays) {
  Outer outer;
  for (std::int64_t i = 0; i < outer_.size(); ++i) {
    if (!stays.at(inner_ + i)) continue;
    outer.keys.push_back(outer_.keys[static_cast<std::size_t>(i)]);
    outer.values.insert(outer.values.end(), outer_values(i), outer_values(i) + column_begins_.back());
  }
  outer_ = std::move(outer);
}

void BlockMeshes::join_pieces() {
  outer_pieces_ = pieces_.size();
  for (std::int64_t v = inner_; v < vertices(); ++v) pieces_.add({}, v);
  std::vector<std::int32_t> near;  // pieces of vertices from `first` on
  std::int64_t first = 0;
  const auto piece_of = [&](std::int64_t vertex) {
    if (vertex >= inner_) return outer_pieces_ + static_cast<std::int32_t>(vertex - inner_);
    if (vertex < first || vertex >= first + std::ssize(near)) {
      constexpr std::int64_t kNear = 1 << 10;
      first = vertex;
      near.resize(static_cast<std::size_t>(std::min(kNear, inner_ - vertex)));
      read_inner(piece_column(), first, std::ssize(near), reinterpret_cast<std::byte*>(near.data()));
    }
    return near[static_cast<std::size_t>(vertex - first)];
  };
  for (const Block& block : blocks_)
    for (std::size_t i = 0; i < block.numbers.size(); ++i) {
      pieces_.unite(block.pieces_of_others[i], piece_of(block.numbers[i]));
      pieces_.reaches(block.pieces_of_others[i], block.numbers[i]);
    }
}

RankedBits BlockMeshes::vertices_that_stay() const {
  RankedBits stays(vertices());
  std::vector<std::int32_t> pieces;
  for (std::int64_t first = 0; first < inner_; first += std::ssize(pieces)) {
    pieces.resize(static_cast<std::size_t>(std::min(kElementsAtOnce, inner_ - first)));
    read_inner(piece_column(), first, std::ssize(pieces), reinterpret_cast<std::byte*>(pieces.data()));
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (pieces_.stays(pieces[i])) stays.set(first + static_cast<std::int64_t>(i));
  }
  for (std::int64_t v = inner_; v < vertices(); ++v)
    if (pieces_.stays(outer_pieces_ + static_cast<std::int32_t>(v - inner_))) stays.set(v);
  stays.count();
  return stays;
}

void BlockMeshes::leave_out(std::size_t number, const RankedBits& stays) {
  Block& block = blocks_[number];
  const std::int64_t first = block.first;
  const std::int64_t count = stays.before(first + block.count) - stays.before(first);
  std::vector<std::uint32_t> numbers;                            // of the others that stay
  std::vector<std::uint32_t> other_of(block.numbers.size(), 0);  // place there
  for (std::size_t i = 0; i < block.numbers.size(); ++i) {
    if (!stays.at(block.numbers[i])) continue;
    other_of[i] = static_cast<std::uint32_t>(numbers.size());
    numbers.push_back(static_cast<std::uint32_t>(stays.before(block.numbers[i])));
  }
  const bool loses_some = count < block.count || numbers.size() < block.numbers.size();
  if (loses_some) {
    auto spool = std::make_unique<Spool>(setup_.folder, triangles_at(count) + block.triangles * kIndexBytes);
    write_columns_that_stay(block, stays, count, *spool);
    write_triangles_that_stay(number, stays, count, other_of, *spool);
    block.spool = std::move(spool);
    block.count = count;
  }
  block.first = stays.before(first);
  block.numbers = std::move(numbers);
}

void BlockMeshes::write_columns_that_stay(const Block& block, const RankedBits& stays, std::int64_t count,
                                          const Spool& out) const {
  std::vector<std::byte> values;
  for (std::size_t c = 0; c < setup_.columns.size(); ++c) {
    const std::int64_t bytes = setup_.columns[c];
    std::int64_t at = count * column_begins_[c];
    for (std::int64_t some = 0; some < block.count; some += kElementsAtOnce) {
      const std::int64_t end = std::min(some + kElementsAtOnce, block.count);
      values.resize(static_cast<std::size_t>((end - some) * bytes));
      block.spool->read(block.count * column_begins_[c] + some * bytes, values.data(), std::ssize(values));
      std::byte* to = values.data();
      for (std::int64_t v = some; v < end; ++v) {
        if (!stays.at(block.first + v)) continue;
        std::memmove(to, values.data() + (v - some) * bytes, static_cast<std::size_t>(bytes));
        to += bytes;
      }
      out.write(at, values.data(), to - values.data());
      at += to - values.data();
    }
  }
}

void BlockMeshes::write_triangles_that_stay(std::size_t number, const RankedBits& stays, std::int64_t count,
                                            const std::vector<std::uint32_t>& other_of, const Spool& out) {
  Block& block = blocks_[number];
  const auto own = static_cast<std::uint32_t>(block.count);
  const std::int64_t before = stays.before(block.first);
  const auto does_stay = [&](std::uint32_t v) {
    return v < own ? stays.at(block.first + v) : stays.at(block.numbers[v - own]);
  };
  const auto renumbered = [&](std::uint32_t v) {
    return v < own ? static_cast<std::uint32_t>(stays.before(block.first + v) - before)
                   : static_cast<std::uint32_t>(count) + other_of[v - own];
  };
  std::int64_t written = 0, at = triangles_at(count);
  std::vector<Indices> triangles;
  for (Chunk& chunk : chunks_) {  // of one block, in the order of its triangles
    if (chunk.block != static_cast<std::int64_t>(number)) continue;
    const std::int64_t first = written;
    for (std::int64_t some = 0; some < chunk.count; some += kElementsAtOnce) {
      triangles.resize(static_cast<std::size_t>(std::min(kElementsAtOnce, chunk.count - some)));
      block.spool->read(triangles_at(block.count) + (chunk.first + some) * kIndexBytes, triangles.data(),
                        std::ssize(triangles) * kIndexBytes);
      std::erase_if(triangles, [&](const Indices& corners) { return !does_stay(corners[0]); });
      for (Indices& corners : triangles)
        for (std::uint32_t& corner : corners) corner = renumbered(corner);
      out.write(at, triangles.data(), std::ssize(triangles) * kIndexBytes);
      at += std::ssize(triangles) * kIndexBytes;
      written += std::ssize(triangles);
    }
    chunk.first = first;
    chunk.count = written - first;
  }
  block.triangles = written;
}

}  // namespace pointskin::scale
