// Meshes of blocks joined, against the mesh that they were cut from.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "exec/cpu.hpp"
#include "scale/block_meshes.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"
#include "surface/pieces.hpp"
#include "unit/scale/mesh_in_blocks.hpp"

namespace pointskin::test {
namespace {

using scale::BlockMeshes;

BlockMeshes::Setup setup_in(const TemporaryFolder& folder) {
  return {std::filesystem::path(folder.file("any")).parent_path().string(),
          kDepth,
          kCellLevel,
          {sizeof(Vec3f), sizeof(std::uint16_t)}};
}

void add(BlockMeshes& meshes, const Whole& part, std::uint64_t begin, std::uint64_t end,
         std::span<const float> density = {}) {
  const std::array columns{reinterpret_cast<const std::byte*>(part.positions.data()),
                           reinterpret_cast<const std::byte*>(part.labels.data())};
  exec::Cpu ex(2);
  meshes.add(ex, {begin, end, part.keys, columns, part.triangles, part.cells, part.segments, density});
}

/// The same with the density of all vertices of the whole.
void add(BlockMeshes& meshes, const Whole& part, std::uint64_t begin, std::uint64_t end, const Whole& whole,
         const std::vector<float>& density) {
  std::vector<float> of_part;
  std::size_t from = 0;  // they are in order
  for (const Vec3f& position : part.positions) {
    while (whole.positions[from] != position) ++from;
    of_part.push_back(density[from++]);
  }
  add(meshes, part, begin, end, of_part);
}

/// @param cuts  ascending keys of finest cells
void cut_and_join(const Whole& whole, std::vector<std::uint64_t> cuts, std::uint64_t seed, BlockMeshes& meshes) {
  Random random(seed);
  cuts.insert(cuts.begin(), 0);
  cuts.push_back(kEnd);
  for (std::size_t b = 0; b + 1 < cuts.size(); ++b)
    add(meshes, part_of(whole, cuts[b], cuts[b + 1], random), cuts[b], cuts[b + 1]);
  meshes.finish();
}

void expect_same(const BlockMeshes& meshes, const Whole& whole) {
  const auto n = static_cast<std::int64_t>(whole.keys.size());
  const auto t = static_cast<std::int64_t>(whole.triangles.size());
  ASSERT_EQ(meshes.vertices(), n);
  ASSERT_EQ(meshes.triangles(), t);
  for (const std::int64_t at_once : {n, std::int64_t{997}}) {
    std::vector<Vec3f> positions(whole.positions.size());
    std::vector<std::uint16_t> labels(whole.labels.size());
    for (std::int64_t first = 0; first < n; first += at_once) {
      const std::int64_t count = std::min(at_once, n - first);
      meshes.read_column(0, first, count, reinterpret_cast<std::byte*>(positions.data() + first));
      meshes.read_column(1, first, count, reinterpret_cast<std::byte*>(labels.data() + first));
    }
    EXPECT_EQ(positions, whole.positions);
    EXPECT_EQ(labels, whole.labels);
  }
  for (const std::int64_t at_once : {t, std::int64_t{1009}}) {
    std::vector<BlockMeshes::Indices> triangles(whole.triangles.size());
    for (std::int64_t first = 0; first < t; first += at_once)
      meshes.read_triangles(first, std::min(at_once, t - first), triangles.data() + first);
    EXPECT_TRUE(std::equal(
        triangles.begin(), triangles.end(), whole.triangles.begin(), whole.triangles.end(),
        [](const BlockMeshes::Indices& a, const Triangle& b) { return std::memcmp(&a, &b, sizeof b) == 0; }));
  }
}

TEST(BlockMeshes, JoinedAreTheMeshThatTheyWereCutFrom) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Whole whole = make_whole(seed);
    ASSERT_GT(std::count_if(whole.keys.begin(), whole.keys.end(), [](std::uint64_t key) { return key >= kEnd; }), 50);
    Random random(seed + 10);
    for (const int blocks : {1, 2, 3, 4, 7, 64}) {
      SCOPED_TRACE(std::to_string(blocks) + " blocks, seed " + std::to_string(seed));
      std::vector<std::uint64_t> cuts;
      for (int b = 1; b < blocks; ++b)  // they may repeat: blocks without cells
        cuts.push_back(finest_key(static_cast<std::uint64_t>(random.below(1 << 3 * kCutLevel)), kCutLevel));
      std::sort(cuts.begin(), cuts.end());
      const TemporaryFolder folder;
      BlockMeshes meshes(setup_in(folder));
      cut_and_join(whole, cuts, seed, meshes);
      expect_same(meshes, whole);
      EXPECT_EQ(folder.file_count(), 0U);
    }
  }
}

/// What stays of a mesh in memory.
Whole without_pieces(const Whole& whole, const surface::PieceOptions& options, surface::PieceCounts& counts) {
  exec::Cpu ex(2);
  surface::Surface surface{exec::make_buffer<Vec3f>(ex, std::ssize(whole.positions)),
                           {},
                           exec::make_buffer<Triangle>(ex, std::ssize(whole.triangles))};
  std::copy(whole.positions.begin(), whole.positions.end(), surface.positions.data());
  std::copy(whole.triangles.begin(), whole.triangles.end(), surface.triangles.data());
  surface = surface::keep_pieces(ex, std::move(surface), options, counts);
  Whole rest;
  rest.positions.assign(surface.positions.data(), surface.positions.data() + surface.positions.size());
  rest.triangles.assign(surface.triangles.data(), surface.triangles.data() + surface.triangles.size());
  std::size_t from = 0;  // they are in order
  for (const Vec3f& position : rest.positions) {
    while (whole.positions[from] != position) ++from;
    rest.keys.push_back(whole.keys[from]);
    rest.labels.push_back(whole.labels[from++]);
  }
  return rest;
}

TEST(BlockMeshes, KeepThePiecesThatTheWholeKeeps) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Whole whole = make_whole(seed, 0.2);
    std::vector<float> density(whole.keys.size());
    Random random(seed + 20);
    std::generate(density.begin(), density.end(), [&] { return static_cast<float>(4 * random.unit()); });
    for (const surface::PieceOptions& options :
         {surface::PieceOptions{}, surface::PieceOptions{.least = 1}, surface::PieceOptions{.least = 4},
          surface::PieceOptions{.largest = true}, surface::PieceOptions{.least = 0.001},
          surface::PieceOptions{.least_samples = 1.5}, surface::PieceOptions{.least = 1e9}})
      for (const int blocks : {1, 5, 40}) {
        SCOPED_TRACE(std::to_string(blocks) + " blocks, seed " + std::to_string(seed));
        surface::PieceOptions in_memory = options;
        in_memory.density = {density.data(), std::ssize(density)};
        surface::PieceCounts expected, found;
        const Whole rest = without_pieces(whole, in_memory, expected);
        if (options.least > 1) {
          EXPECT_GT(expected.pieces_removed, 20);
        }
        const TemporaryFolder folder;
        BlockMeshes::Setup setup = setup_in(folder);
        setup.pieces = true;
        BlockMeshes meshes(setup);
        std::uint64_t begin = 0;
        for (int b = 1; b <= blocks; ++b) {
          const std::uint64_t end = finest_key(
              (std::uint64_t{1} << 3 * kCutLevel) * static_cast<std::uint64_t>(b) / static_cast<std::uint64_t>(blocks),
              kCutLevel);
          add(meshes, part_of(whole, begin, end, random, false), begin, end, whole, density);
          begin = end;
        }
        meshes.finish();
        found = meshes.keep_pieces(options);
        EXPECT_EQ(found.pieces, expected.pieces);
        EXPECT_EQ(found.pieces_removed, expected.pieces_removed);
        EXPECT_EQ(found.triangles_removed, expected.triangles_removed);
        expect_same(meshes, rest);
      }
  }
}

TEST(BlockMeshes, OfNothingAreAnEmptyMesh) {
  const TemporaryFolder folder;
  BlockMeshes meshes(setup_in(folder));
  cut_and_join({}, {finest_key(7, kCutLevel)}, 1, meshes);
  EXPECT_EQ(meshes.vertices(), 0);
  EXPECT_EQ(meshes.triangles(), 0);
  meshes.read_triangles(0, 0, nullptr);
  meshes.read_column(0, 0, 0, nullptr);
}

TEST(BlockMeshes, ThatLackAVertexOfATriangleAreAnError) {
  const Whole whole = make_whole(4);
  const std::uint64_t cut = finest_key(20, kCutLevel);
  Random random(1);
  const TemporaryFolder folder;
  BlockMeshes meshes(setup_in(folder));
  add(meshes, part_of(whole, 0, cut, random), 0, cut);
  try {
    meshes.finish();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
  }
}

}  // namespace
}  // namespace pointskin::test
