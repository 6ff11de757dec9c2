#include "scale/block_meshes.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <numeric>
#include <tuple>
#include <utility>

#include "octree/keys.hpp"

namespace pointskin::scale {
namespace {

constexpr std::int64_t kTrianglesAtOnce = 64 << 10;

/// Place of an element among those before it that are equal under `what`, in a sorted array.
template <class What>
std::int64_t place_among_equals(std::span<const std::uint64_t> keys, std::size_t at, const What& what) {
  const auto first = std::partition_point(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(at),
                                          [&](std::uint64_t key) { return what(key) < what(keys[at]); });
  return keys.begin() + static_cast<std::ptrdiff_t>(at) - first;
}

}  // namespace

BlockMeshes::BlockMeshes(Setup setup) : setup_(std::move(setup)) {
  if (setup_.pieces) setup_.columns.push_back(sizeof(std::int32_t));
  column_begins_.push_back(0);
  for (const std::int64_t bytes : setup_.columns) column_begins_.push_back(column_begins_.back() + bytes);
}

std::uint64_t BlockMeshes::owner_of_outer(std::uint64_t key) const {
  const octree::Coordinates corner = octree::decode(key);
  const std::int32_t last = (1 << setup_.depth) - 1;
  return octree::encode({std::min(corner.x, last), std::min(corner.y, last), std::min(corner.z, last)});
}

void BlockMeshes::add(exec::Cpu& ex, const BlockMesh& from) {
  Block block;
  block.first = inner_;
  const auto first = static_cast<std::size_t>(std::ranges::lower_bound(from.keys, from.begin) - from.keys.begin());
  count_vertices(from, first, block);
  add_outer(from);
  block.triangles = count_triangles(from);
  block.spool = std::make_unique<Spool>(setup_.folder, triangles_at(block.count) + block.triangles * kIndexBytes,
                                        setup_.team.is_alone() ? SpoolName::never : SpoolName::when_shown);
  std::vector<std::int32_t> pieces;
  if (setup_.pieces) pieces = add_pieces(from, first, block);
  write_vertices(ex, from, first, pieces, block);
  write_triangles(ex, from, first, pieces, block);
  inner_ += block.count;
  triangles_ += block.triangles;
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
    outer_.keys.push_back(*key);
    outer_.values.resize(static_cast<std::size_t>(outer_.size() * column_begins_.back()));
    const std::int64_t v = key - from.keys.begin();
    for (std::size_t c = 0; c < from.columns.size(); ++c)
      std::memcpy(outer_values(outer_.size() - 1) + column_begins_[c], from.columns[c] + v * setup_.columns[c],
                  static_cast<std::size_t>(setup_.columns[c]));
  }
}

void BlockMeshes::sort_outer() {
  std::vector<std::int64_t> order(outer_.keys.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::int64_t i) { return outer_.keys[static_cast<std::size_t>(i)]; });
  Outer sorted;
  sorted.values.reserve(outer_.values.size());
  for (const std::int64_t i : order) {
    sorted.keys.push_back(outer_.keys[static_cast<std::size_t>(i)]);
    sorted.values.insert(sorted.values.end(), outer_values(i), outer_values(i) + column_begins_.back());
  }
  outer_ = std::move(sorted);
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

std::vector<std::int32_t> BlockMeshes::add_pieces(const BlockMesh& from, std::size_t first, const Block& block) {
  std::vector<std::uint8_t> is_own(from.cells.size());
  std::ranges::transform(from.cells, is_own.begin(),
                         [&](std::uint64_t cell) { return static_cast<std::uint8_t>(from.owns(cell)); });
  PiecesOfPart pieces = find_pieces({{reinterpret_cast<const Vec3f*>(from.columns[0]), from.keys.size()},
                                     from.triangles,
                                     is_own,
                                     from.density,
                                     first,
                                     static_cast<std::size_t>(block.count)});
  keep_found(pieces, block, first);
  return std::move(pieces.piece_of);
}

void BlockMeshes::keep_found(PiecesOfPart& pieces, const Block& block, std::size_t first) {
  const std::int32_t before = pieces_.size();
  for (std::size_t p = 0; p < pieces.extents.size(); ++p) {
    const std::int64_t own = pieces.first_own_vertex[p];
    pieces_.add(pieces.extents[p],
                own == PiecesOfPart::kNone ? own : block.first + own - static_cast<std::int64_t>(first));
  }
  for (std::int32_t& piece : pieces.piece_of)
    if (piece >= 0) piece += before;
}

void BlockMeshes::write_vertices(exec::Cpu& ex, const BlockMesh& from, std::size_t first,
                                 std::span<const std::int32_t> pieces, const Block& block) const {
  const auto write = [&](std::size_t column, const std::byte* values) {
    block.spool->write(ex, block.count * column_begins_[column],
                       values + static_cast<std::int64_t>(first) * setup_.columns[column],
                       block.count * setup_.columns[column]);
  };
  for (std::size_t c = 0; c < from.columns.size(); ++c) write(c, from.columns[c]);
  if (!pieces.empty()) write(piece_column(), reinterpret_cast<const std::byte*>(pieces.data()));
}

void BlockMeshes::write_triangles(exec::Cpu& ex, const BlockMesh& from, std::size_t first,
                                  std::span<const std::int32_t> pieces, Block& block) const {
  const auto all = std::ssize(from.triangles);
  const std::int64_t parts = (all + kTrianglesAtOnce - 1) / kTrianglesAtOnce;
  const auto for_own = [&](std::int64_t part, const auto& visit) {
    const std::int64_t end = std::min(all, (part + 1) * kTrianglesAtOnce);
    for (std::int64_t t = part * kTrianglesAtOnce; t < end; ++t)
      if (from.owns(from.cells[static_cast<std::size_t>(t)])) visit(from.triangles[static_cast<std::size_t>(t)]);
  };
  const auto is_own = [&](std::size_t v) { return v - first < static_cast<std::size_t>(block.count); };

  std::vector<std::int64_t> before(static_cast<std::size_t>(parts) + 1, 0);  // own triangles, of each part
  std::vector<std::uint8_t> is_needed(from.keys.size(), 0);                  // of others
  ex.run_blocks(parts, [&](std::int64_t part) {
    std::int64_t count = 0;
    for_own(part, [&](const Triangle& corners) {
      ++count;
      for (const std::int32_t corner : corners) {
        const auto v = static_cast<std::size_t>(corner);
        if (!is_own(v)) std::atomic_ref(is_needed[v]).store(1, std::memory_order_relaxed);
      }
    });
    before[static_cast<std::size_t>(part) + 1] = count;
  });
  std::partial_sum(before.begin(), before.end(), before.begin());

  std::vector<std::uint32_t> other_of(from.keys.size(), 0);  // place in block.others
  for (std::size_t v = 0; v < is_needed.size(); ++v) {
    if (is_needed[v] == 0) continue;
    other_of[v] = static_cast<std::uint32_t>(block.others.size());
    block.others.push_back(reference_to(from.keys, v));
    if (!pieces.empty()) block.pieces_of_others.push_back(pieces[v]);
  }
  const auto local = [&](std::int32_t corner) {
    const auto v = static_cast<std::size_t>(corner);
    return static_cast<std::uint32_t>(is_own(v) ? static_cast<std::int64_t>(v - first) : block.count + other_of[v]);
  };
  ex.run_blocks(parts, [&](std::int64_t part) {
    const std::int64_t at = before[static_cast<std::size_t>(part)];
    std::vector<Indices> own;
    own.reserve(static_cast<std::size_t>(before[static_cast<std::size_t>(part) + 1] - at));
    for_own(part, [&](const Triangle& corners) {
      own.push_back({local(corners[0]), local(corners[1]), local(corners[2])});
    });
    block.spool->write(triangles_at(block.count) + at * kIndexBytes, own.data(), std::ssize(own) * kIndexBytes);
  });
}

BlockMeshes::Reference BlockMeshes::reference_to(std::span<const std::uint64_t> keys, std::size_t v) const {
  const std::uint64_t key = keys[v];
  if (is_outer(key)) return {key | kOuter, place_among_equals(keys, v, [](std::uint64_t k) { return k; })};
  return {cell_of(key), place_among_equals(keys, v, [&](std::uint64_t k) { return cell_of(k); })};
}

void BlockMeshes::finish() {
  if (!setup_.team.is_alone()) join();
  if (vertices() > std::int64_t{1} << 32)
    throw Error(ErrorCode::over_limit,
                "the mesh has " + std::to_string(vertices()) + " vertices, more than 32-bit indices reach");
  sort_outer();
  for (Block& block : blocks_) {
    block.numbers.reserve(block.others.size());
    for (const Reference& vertex : block.others) block.numbers.push_back(number_of(vertex));
    block.others = {};
  }
  cells_ = {};
  std::ranges::stable_sort(chunks_, {}, [](const Chunk& chunk) { return std::tuple(chunk.segment, chunk.block); });
  place_chunks();
}

void BlockMeshes::place_chunks() {
  triangles_ = 0;
  for (Chunk& chunk : chunks_) {
    chunk.before = triangles_;
    triangles_ += chunk.count;
  }
}

std::uint32_t BlockMeshes::number_of(const Reference& vertex) const {
  std::int64_t number = -1;
  if ((vertex.key & kOuter) != 0) {
    const std::uint64_t key = vertex.key & ~kOuter;
    const auto [first, last] = std::equal_range(outer_.keys.begin(), outer_.keys.end(), key);
    if (vertex.place < last - first) number = inner_ + (first - outer_.keys.begin()) + vertex.place;
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
    std::memcpy(out + i * bytes, outer_values(first + i - inner_) + column_begins_[column],
                static_cast<std::size_t>(bytes));
}

void BlockMeshes::read_column(std::size_t column, std::span<const std::int64_t> vertices, std::byte* out) const {
  const auto number = [&](std::int64_t i) { return vertices[static_cast<std::size_t>(i)]; };
  constexpr std::int64_t kGap = 256, kMost = 64 << 10;  // a few more are sooner read than asked for again
  const std::int64_t bytes = setup_.columns[column];
  std::vector<std::byte> values;
  for (std::int64_t begin = 0, end = 0; begin < std::ssize(vertices); begin = end) {
    for (end = begin + 1; end < std::ssize(vertices); ++end)
      if (number(end) - number(end - 1) > kGap || number(end) - number(begin) >= kMost) break;
    const std::int64_t count = number(end - 1) - number(begin) + 1;
    values.resize(static_cast<std::size_t>(count * bytes));
    read_column(column, number(begin), count, values.data());
    for (std::int64_t i = begin; i < end; ++i, out += bytes)
      std::memcpy(out, values.data() + (number(i) - number(begin)) * bytes, static_cast<std::size_t>(bytes));
  }
}

void BlockMeshes::mark_shared(RankedBits& vertices) const {
  for (const Block& block : blocks_)
    for (const std::uint32_t vertex : block.numbers) vertices.set(vertex);
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
    block.spool->read(triangles_at(block.count) + (from.first + begin) * kIndexBytes, out, some * kIndexBytes);
    const auto own = static_cast<std::uint32_t>(block.count);
    for (std::int64_t t = 0; t < some; ++t)
      for (std::uint32_t& vertex : out[t])
        vertex = vertex < own ? static_cast<std::uint32_t>(block.first) + vertex : block.numbers[vertex - own];
    first += some;
    count -= some;
    out += some;
  }
}

BlockMeshes::MeshOfBlock BlockMeshes::read_block(std::int64_t number) const {
  const Block& block = blocks_[static_cast<std::size_t>(number)];
  const auto own = static_cast<std::size_t>(block.count);
  MeshOfBlock mesh;
  mesh.triangles.resize(static_cast<std::size_t>(block.triangles));
  block.spool->read(triangles_at(block.count), mesh.triangles.data(), block.triangles * kIndexBytes);
  std::vector<std::int32_t> place_of(own + block.numbers.size(), 0);
  for (const Triangle& corners : mesh.triangles)
    for (const std::int32_t v : corners) place_of[static_cast<std::size_t>(v)] = 1;
  const auto number_in_whole = [&](std::size_t v) {
    return v < own ? block.first + static_cast<std::int64_t>(v) : std::int64_t{block.numbers[v - own]};
  };
  std::vector<std::size_t> used;
  for (std::size_t v = 0; v < place_of.size(); ++v)
    if (place_of[v] != 0) used.push_back(v);
  std::ranges::sort(used, {}, number_in_whole);
  for (const std::size_t v : used) {
    place_of[v] = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.push_back(number_in_whole(v));
  }
  for (Triangle& corners : mesh.triangles)
    for (std::int32_t& v : corners) v = place_of[static_cast<std::size_t>(v)];
  return mesh;
}

}  // namespace pointskin::scale
