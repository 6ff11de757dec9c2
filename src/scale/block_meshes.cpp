#include "scale/block_meshes.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstring>
#include <limits>
#include <tuple>
#include <utility>

#include "octree/keys.hpp"

namespace pointskin::scale {
namespace {

constexpr std::int64_t kIndexBytes = sizeof(BlockMeshes::Indices);
constexpr std::int64_t kTrianglesAtOnce = 64 << 10;
constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();

/// Place of an element among those before it that are equal under `what`, in a sorted array.
template <class What>
std::int64_t place_among_equals(std::span<const std::uint64_t> keys, std::size_t at, const What& what) {
  const auto first = std::partition_point(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(at),
                                          [&](std::uint64_t key) { return what(key) < what(keys[at]); });
  return keys.begin() + static_cast<std::ptrdiff_t>(at) - first;
}

}  // namespace

BlockMeshes::BlockMeshes(Setup setup) : setup_(std::move(setup)) {
  column_begins_.push_back(0);
  for (const std::int64_t bytes : setup_.columns) column_begins_.push_back(column_begins_.back() + bytes);
}

std::uint64_t BlockMeshes::owner_of_outer(std::uint64_t key) const {
  const octree::Coordinates corner = octree::decode(key);
  const std::int32_t last = (1 << setup_.depth) - 1;
  return octree::encode({std::min(corner.x, last), std::min(corner.y, last), std::min(corner.z, last)});
}

void BlockMeshes::add(const BlockMesh& from) {
  Block block;
  block.first = inner_;
  const auto first = static_cast<std::size_t>(std::ranges::lower_bound(from.keys, from.begin) - from.keys.begin());
  count_vertices(from, first, block);
  add_outer(from);
  const std::int64_t triangles = count_triangles(from);
  block.spool = std::make_unique<Spool>(setup_.folder, block.count * column_begins_.back() + triangles * kIndexBytes);
  write_vertices(from, first, block);
  write_triangles(from, first, block);
  inner_ += block.count;
  triangles_ += triangles;
  blocks_.push_back(std::move(block));
}

void BlockMeshes::count_vertices(const BlockMesh& from, std::size_t first, Block& block) {
  const std::uint64_t end = std::min(from.end, std::uint64_t{1} << 3 * setup_.depth);  // outer ones are not among them
  const auto last = static_cast<std::size_t>(std::ranges::lower_bound(from.keys, end) - from.keys.begin());
  for (std::size_t v = first; v < last; ++v) {
    const std::uint64_t cell = cell_of(from.keys[v]);
    if (cells_.empty() || cells_.back().key != cell) cells_.push_back({cell, inner_ + block.count, 0});
    ++cells_.back().count;
    ++block.count;
  }
}

void BlockMeshes::add_outer(const BlockMesh& from) {
  const auto first = std::ranges::lower_bound(from.keys, std::uint64_t{1} << 3 * setup_.depth);
  for (auto key = first; key != from.keys.end(); ++key) {
    const std::uint64_t owner = owner_of_outer(*key);
    if (!from.owns(owner)) continue;
    Outer vertex{*key, std::vector<std::byte>(static_cast<std::size_t>(column_begins_.back()))};
    const std::int64_t v = key - from.keys.begin();
    for (std::size_t c = 0; c < setup_.columns.size(); ++c)
      std::memcpy(vertex.values.data() + column_begins_[c], from.columns[c] + v * setup_.columns[c],
                  static_cast<std::size_t>(setup_.columns[c]));
    outer_.push_back(std::move(vertex));
  }
}

std::int64_t BlockMeshes::count_triangles(const BlockMesh& from) {
  std::int64_t own = 0;
  for (std::size_t t = 0; t < from.triangles.size(); ++t) {
    if (!from.owns(from.cells[t])) continue;
    const bool begins = own == 0 || chunks_.back().segment != from.segments[t];
    if (begins) chunks_.push_back({from.segments[t], std::ssize(blocks_), own, 0, 0});
    ++chunks_.back().count;
    ++own;
  }
  return own;
}

void BlockMeshes::write_vertices(const BlockMesh& from, std::size_t first, const Block& block) const {
  for (std::size_t c = 0; c < setup_.columns.size(); ++c)
    block.spool->write(block.count * column_begins_[c],
                       from.columns[c] + static_cast<std::int64_t>(first) * setup_.columns[c],
                       block.count * setup_.columns[c]);
}

void BlockMeshes::write_triangles(const BlockMesh& from, std::size_t first, Block& block) const {
  std::vector<std::uint32_t> other_of(from.keys.size(), kNone);  // place in block.others
  const auto local = [&](std::int32_t vertex) -> std::uint32_t {
    const auto v = static_cast<std::size_t>(vertex);
    if (v >= first && v < first + static_cast<std::size_t>(block.count)) return static_cast<std::uint32_t>(v - first);
    if (other_of[v] == kNone) {
      other_of[v] = static_cast<std::uint32_t>(block.others.size());
      block.others.push_back(reference_to(from.keys, v));
    }
    return static_cast<std::uint32_t>(block.count) + other_of[v];
  };
  std::vector<Indices> some;
  std::int64_t at = block.count * column_begins_.back();
  const auto flush = [&] {
    const std::int64_t bytes = std::ssize(some) * kIndexBytes;
    block.spool->write(at, some.data(), bytes);
    at += bytes;
    some.clear();
  };
  for (std::size_t t = 0; t < from.triangles.size(); ++t) {
    if (!from.owns(from.cells[t])) continue;
    const Triangle& corners = from.triangles[t];
    some.push_back({local(corners[0]), local(corners[1]), local(corners[2])});
    if (std::ssize(some) == kTrianglesAtOnce) flush();
  }
  flush();
}

BlockMeshes::Reference BlockMeshes::reference_to(std::span<const std::uint64_t> keys, std::size_t v) const {
  const std::uint64_t key = keys[v];
  if (is_outer(key)) return {key | kOuter, place_among_equals(keys, v, [](std::uint64_t k) { return k; })};
  return {cell_of(key), place_among_equals(keys, v, [&](std::uint64_t k) { return cell_of(k); })};
}

void BlockMeshes::finish() {
  if (vertices() > std::int64_t{1} << 32)
    throw Error(ErrorCode::over_limit,
                "the mesh has " + std::to_string(vertices()) + " vertices, more than 32-bit indices reach");
  std::ranges::stable_sort(outer_, {}, &Outer::key);
  for (Block& block : blocks_) {
    block.numbers.reserve(block.others.size());
    for (const Reference& vertex : block.others) block.numbers.push_back(number_of(vertex));
    block.others = {};
  }
  std::ranges::stable_sort(chunks_, {}, [](const Chunk& chunk) { return std::tuple(chunk.segment, chunk.block); });
  std::int64_t before = 0;
  for (Chunk& chunk : chunks_) {
    chunk.before = before;
    before += chunk.count;
  }
}

std::uint32_t BlockMeshes::number_of(const Reference& vertex) const {
  std::int64_t number = -1;
  if ((vertex.key & kOuter) != 0) {
    const std::uint64_t key = vertex.key & ~kOuter;
    const std::int64_t first = std::ranges::lower_bound(outer_, key, {}, &Outer::key) - outer_.begin();
    const std::int64_t last = std::ranges::upper_bound(outer_, key, {}, &Outer::key) - outer_.begin();
    if (vertex.place < last - first) number = inner_ + first + vertex.place;
  } else {
    const auto cell = std::ranges::lower_bound(cells_, vertex.key, {}, &Cell::key);
    if (cell != cells_.end() && cell->key == vertex.key && vertex.place < cell->count)
      number = cell->first + vertex.place;
  }
  if (number < 0) throw Error(ErrorCode::internal, "a block has a triangle with a vertex that no block has");
  return static_cast<std::uint32_t>(number);
}

void BlockMeshes::read_column(std::size_t column, std::int64_t first, std::int64_t count, std::byte* out) const {
  const std::int64_t bytes = setup_.columns[column];
  const std::int64_t inner = std::clamp<std::int64_t>(inner_ - first, 0, count);
  read_inner(column, first, inner, out);
  for (std::int64_t i = inner; i < count; ++i)
    std::memcpy(out + i * bytes,
                outer_[static_cast<std::size_t>(first + i - inner_)].values.data() + column_begins_[column],
                static_cast<std::size_t>(bytes));
}

void BlockMeshes::read_inner(std::size_t column, std::int64_t first, std::int64_t count, std::byte* out) const {
  const std::int64_t bytes = setup_.columns[column];
  auto block = std::ranges::upper_bound(blocks_, first, {}, &Block::first);
  while (count > 0) {
    const Block& from = *std::prev(block++);
    const std::int64_t begin = first - from.first;
    const std::int64_t some = std::min(count, from.count - begin);
    from.spool->read(from.count * column_begins_[column] + begin * bytes, out, some * bytes);
    first += some;
    count -= some;
    out += some * bytes;
  }
}

void BlockMeshes::read_triangles(std::int64_t first, std::int64_t count, Indices* out) const {
  auto chunk = std::ranges::upper_bound(chunks_, first, {}, &Chunk::before);
  while (count > 0) {
    const Chunk& from = *std::prev(chunk++);
    const Block& block = blocks_[static_cast<std::size_t>(from.block)];
    const std::int64_t begin = first - from.before;
    const std::int64_t some = std::min(count, from.count - begin);
    block.spool->read(block.count * column_begins_.back() + (from.first + begin) * kIndexBytes, out,
                      some * kIndexBytes);
    const auto own = static_cast<std::uint32_t>(block.count);
    for (std::int64_t t = 0; t < some; ++t)
      for (std::uint32_t& vertex : out[t])
        vertex = vertex < own ? static_cast<std::uint32_t>(block.first) + vertex : block.numbers[vertex - own];
    first += some;
    count -= some;
    out += some;
  }
}

}  // namespace pointskin::scale
