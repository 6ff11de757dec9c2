// The mesh of blocks cut, against the whole that is cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "exec/cpu.hpp"
#include "scale/block_meshes.hpp"
#include "scale/block_trim.hpp"
#include "support/io_files.hpp"
#include "surface/pieces.hpp"
#include "surface/trim.hpp"
#include "unit/scale/mesh_in_blocks.hpp"

namespace pointskin::test {
namespace {

using scale::BlockMeshes;

template <class T>
exec::Buffer<T> buffer_of(exec::Cpu& ex, const std::vector<T>& values) {
  auto buffer = exec::make_buffer<T>(ex, std::ssize(values));
  std::copy(values.begin(), values.end(), buffer.data());
  return buffer;
}

/// Without vertices that no triangle has: extraction makes none.
Whole made_whole(std::uint64_t seed, double density) {
  const Whole all = make_whole(seed, density);
  std::vector<std::int32_t> number(all.keys.size(), -1);
  for (const Triangle& t : all.triangles)
    for (const std::int32_t v : t) number[static_cast<std::size_t>(v)] = 0;
  Whole whole = all;
  std::int32_t count = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = count;
    const auto to = static_cast<std::size_t>(count++);
    whole.keys[to] = all.keys[v];
    whole.positions[to] = all.positions[v];
    whole.normals[to] = all.normals[v];
    whole.values[to] = all.values[v];
    whole.labels[to] = all.labels[v];
  }
  const auto n = static_cast<std::size_t>(count);
  whole.keys.resize(n);
  whole.positions.resize(n);
  whole.normals.resize(n);
  whole.values.resize(n);
  whole.labels.resize(n);
  for (Triangle& t : whole.triangles)
    for (std::int32_t& v : t) v = number[static_cast<std::size_t>(v)];
  return whole;
}

surface::Surface surface_of(exec::Cpu& ex, const Whole& whole) {
  return {buffer_of(ex, whole.positions), buffer_of(ex, whole.normals), buffer_of(ex, whole.triangles)};
}

/// Blocks with positions, normals and values, which are right in a vertex's own block alone.
void make_blocks(const Whole& whole, int blocks, std::uint64_t seed, BlockMeshes& meshes) {
  Random random(seed);
  exec::Cpu ex(2);
  std::uint64_t begin = 0;
  for (int b = 1; b <= blocks; ++b) {
    const std::uint64_t end = finest_key(
        (std::uint64_t{1} << 3 * kCutLevel) * static_cast<std::uint64_t>(b) / static_cast<std::uint64_t>(blocks),
        kCutLevel);
    const Whole part = part_of(whole, begin, end, random);
    const std::array columns{reinterpret_cast<const std::byte*>(part.positions.data()),
                             reinterpret_cast<const std::byte*>(part.normals.data()),
                             reinterpret_cast<const std::byte*>(part.values.data())};
    meshes.add(ex, {begin, end, part.keys, columns, part.triangles, part.cells, part.segments, {}});
    begin = end;
  }
  meshes.finish();
}

template <class T>
bool same(const std::vector<T>& found, const exec::Buffer<T>& expected) {
  return std::ssize(found) == expected.size() &&
         (found.empty() || std::memcmp(found.data(), expected.data(), found.size() * sizeof(T)) == 0);
}

void expect_same(const BlockMeshes& meshes, const surface::Surface& expected) {
  ASSERT_EQ(meshes.vertices(), expected.positions.size());
  ASSERT_EQ(meshes.triangles(), expected.triangles.size());
  std::vector<Vec3f> positions(static_cast<std::size_t>(meshes.vertices())), normals(positions.size());
  meshes.read_column(0, 0, meshes.vertices(), reinterpret_cast<std::byte*>(positions.data()));
  meshes.read_column(1, 0, meshes.vertices(), reinterpret_cast<std::byte*>(normals.data()));
  std::vector<Triangle> triangles(static_cast<std::size_t>(meshes.triangles()));
  meshes.read_triangles(0, meshes.triangles(), reinterpret_cast<BlockMeshes::Indices*>(triangles.data()));
  EXPECT_TRUE(same(positions, expected.positions));
  EXPECT_TRUE(same(normals, expected.normals));
  EXPECT_TRUE(same(triangles, expected.triangles));
}

void expect_same(const surface::TrimCounts& found, const surface::TrimCounts& expected) {
  EXPECT_EQ(found.area_before, expected.area_before);
  EXPECT_EQ(found.area_kept, expected.area_kept);
  EXPECT_EQ(found.triangles_before, expected.triangles_before);
  EXPECT_EQ(found.triangles_removed, expected.triangles_removed);
  EXPECT_EQ(found.triangles_split, expected.triangles_split);
  EXPECT_EQ(found.islands_removed, expected.islands_removed);
  EXPECT_EQ(found.holes_filled, expected.holes_filled);
}

class BlockTrim : public testing::Test {
 protected:
  /// Blocks cut at a limit, and pieces left out then unless `pieces` asks for none.
  void expect_as_whole(const Whole& whole, int blocks, const surface::TrimOptions& options,
                       const surface::PieceOptions* pieces = nullptr) {
    SCOPED_TRACE(std::to_string(blocks) + " blocks, limit " + std::to_string(options.limit) + ", islands " +
                 std::to_string(options.island_ratio));
    exec::Cpu ex(2);
    const exec::Buffer<float> values = buffer_of(ex, whole.values);
    surface::TrimCounts found;
    counts_ = {};
    surface::Surface expected = surface::trim_surface(ex, surface_of(ex, whole), values.cview(), options, counts_);
    const TemporaryFolder folder;
    BlockMeshes meshes({std::filesystem::path(folder.file("any")).parent_path().string(),
                        kDepth,
                        kCellLevel,
                        {sizeof(Vec3f), sizeof(Vec3f), sizeof(float)}});
    make_blocks(whole, blocks, 7, meshes);
    const scale::BlockCut cut = scale::find_cut(meshes, {0, 1, 2}, options, found);
    meshes.cut(ex, cut, pieces != nullptr, {});
    expect_same(found, counts_);
    if (pieces == nullptr) return expect_same(meshes, expected);
    surface::PieceCounts in_whole;
    expected = surface::keep_pieces(ex, std::move(expected), *pieces, in_whole);
    const surface::PieceCounts in_blocks = meshes.keep_pieces(*pieces);
    EXPECT_EQ(in_blocks.pieces, in_whole.pieces);
    EXPECT_EQ(in_blocks.pieces_removed, in_whole.pieces_removed);
    EXPECT_EQ(in_blocks.triangles_removed, in_whole.triangles_removed);
    expect_same(meshes, expected);
  }

  surface::TrimCounts counts_;  ///< of the whole, last
};

TEST_F(BlockTrim, CutsAsTheWholeIsCut) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Whole whole = made_whole(seed, 1);
    for (const int blocks : {1, 2, 7, 40}) {
      expect_as_whole(whole, blocks, {0.1F, 0});
      EXPECT_GT(counts_.triangles_split, 1000);
      EXPECT_GT(counts_.triangles_removed, 1000);
    }
  }
}

TEST_F(BlockTrim, ClearsSmallPiecesOfBothSidesAcrossBlocks) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Whole whole = made_whole(seed, 0.3);
    for (const int blocks : {1, 5, 40})
      for (const double islands : {1e-5, 1e-4, 0.01}) {
        expect_as_whole(whole, blocks, {0.1F, islands});
        EXPECT_GT(counts_.islands_removed, 0);
        EXPECT_GT(counts_.holes_filled, 0);
      }
  }
}

TEST_F(BlockTrim, LeavesAllOrNothing) {
  const Whole whole = made_whole(4, 1);
  for (const int blocks : {1, 6}) {
    expect_as_whole(whole, blocks, {10, 0});
    EXPECT_EQ(counts_.triangles_removed, 0);
    expect_as_whole(whole, blocks, {-10, 0});
    EXPECT_EQ(counts_.triangles_removed, counts_.triangles_before);
  }
}

TEST_F(BlockTrim, FindsThePiecesOfWhatIsLeft) {
  const Whole whole = made_whole(5, 0.2);
  for (const int blocks : {1, 7, 40}) {
    surface::PieceOptions pieces{.least = 4};
    expect_as_whole(whole, blocks, {0.1F, 1e-4}, &pieces);
    pieces = {.largest = true};
    expect_as_whole(whole, blocks, {0.1F, 0}, &pieces);
    expect_as_whole(whole, blocks, {10, 0}, &pieces);
  }
}

}  // namespace
}  // namespace pointskin::test
