// Files reconstructed in blocks on the GPU against the whole on the CPU: the same bytes.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/scale.hpp>

#include <cstddef>
#include <cstdint>
#include <string>

#include "parity/gpu_test.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

constexpr std::int64_t kMegabyte = 1'000'000;

class BlocksOnGpu : public test::GpuTest {
 protected:
  /// Within memory that takes more than one block.
  void expect_parity(const Cloud& cloud, const Options& options, std::int64_t memory_bytes) {
    write_cloud(input_, cloud);
    Reconstructor whole(Device::cpu());
    write_mesh(whole_, whole.reconstruct(read_cloud(input_), options));
    const FilesReport files = reconstruct_files({input_}, output_, options, scale(memory_bytes));
    EXPECT_TRUE(test::bytes_of_file(output_) == test::bytes_of_file(whole_));
    EXPECT_GT(files.blocks, 1);
    EXPECT_EQ(files.run.isovalue, whole.report().isovalue);
    EXPECT_EQ(files.run.nodes, whole.report().nodes);
    EXPECT_EQ(files.run.pieces.pieces_removed, whole.report().pieces.pieces_removed);
    EXPECT_LE(files.run.device_peak_bytes, memory_bytes);
    ASSERT_EQ(files.run.warnings.size(), whole.report().warnings.size());
    for (std::size_t i = 0; i < files.run.warnings.size(); ++i)
      EXPECT_EQ(files.run.warnings[i].text, whole.report().warnings[i].text);
  }

  [[nodiscard]] ScaleOptions scale(std::int64_t memory_bytes) const {
    ScaleOptions scale;
    scale.max_memory_bytes = memory_bytes;
    scale.temp_folder = folder_.file("");
    scale.device = gpu_;
    return scale;
  }

  test::TemporaryFolder folder_;
  std::string input_ = folder_.file("cloud.ply"), output_ = folder_.file("blocks.ply"),
              whole_ = folder_.file("whole.ply");
};

// A case a test: each takes minutes where a tool watches the GPU.
TEST_F(BlocksOnGpu, OfATorusGiveTheFileOfTheWhole) {
  expect_parity(test::torus_cloud(60'000, 1), {{.depth = 8}}, 60 * kMegabyte);
}

TEST_F(BlocksOnGpu, ThatAreManyGiveTheFileOfTheWhole) {
  expect_parity(test::torus_cloud(60'000, 1), {{.depth = 8}}, 50 * kMegabyte);
}

TEST_F(BlocksOnGpu, OfMoreLevelsGiveTheFileOfTheWhole) {
  expect_parity(test::torus_cloud(60'000, 1), {{.depth = 9, .iterations = 4}}, 160 * kMegabyte);
}

TEST_F(BlocksOnGpu, WithValuesOnTheFacesGiveTheFileOfTheWhole) {
  expect_parity(test::linked_tori_cloud(60'000, 2), {{.depth = 8, .boundary = Boundary::dirichlet}, {.density = true}},
                50 * kMegabyte);
}

TEST_F(BlocksOnGpu, WithoutScreeningGiveTheFileOfTheWhole) {
  expect_parity(test::linked_tori_cloud(60'000, 2), {{.depth = 8, .screening = 0}, {.largest = true}}, 50 * kMegabyte);
}

TEST_F(BlocksOnGpu, ByConfidenceGiveTheFileOfTheWhole) {
  expect_parity(test::linked_tori_cloud(60'000, 2), {{.depth = 8, .confidence = true}, {.min_component = 0.1}},
                50 * kMegabyte);
}

TEST_F(BlocksOnGpu, WithOpenFacesGiveTheFileOfTheWhole) {
  expect_parity(test::linked_tori_cloud(60'000, 2), {{.depth = 8}, {.domain_faces = DomainFaces::open}},
                50 * kMegabyte);
}

/// A sphere with a hole.
Cloud open_cloud() {
  Cloud cloud;
  const Cloud sphere = test::sphere_cloud(60'000, 8);
  for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
    if (sphere.positions[i].z > 0.6F) continue;
    cloud.positions.push_back(sphere.positions[i]);
    cloud.normals.push_back(sphere.normals[i]);
  }
  return cloud;
}

TEST_F(BlocksOnGpu, ThatAreCutGiveTheFileOfTheWhole) {
  Options options{{.depth = 8}, {.density = true}};
  options.trim = 0.02;
  expect_parity(open_cloud(), options, 75 * kMegabyte);
}

TEST_F(BlocksOnGpu, ThatAreCutByThemselvesGiveTheFileOfTheWhole) {
  Options options{{.depth = 8}};
  options.trim = Options::kAutomaticTrim;
  expect_parity(open_cloud(), options, 75 * kMegabyte);
}

Cloud noise_and_outliers() {
  Cloud cloud = test::jittered(test::sphere_cloud(60'000, 3), 4, 0.004);
  test::append(cloud, test::jittered(test::box_cloud(300, 5), 6, 0.3));
  return cloud;
}

TEST_F(BlocksOnGpu, OfNoiseAndOutliersGiveTheFileOfTheWhole) {
  expect_parity(noise_and_outliers(), {{.depth = 8, .iterations = 4}}, 50 * kMegabyte);
}

TEST_F(BlocksOnGpu, ThatAreInsideOutGiveTheFileOfTheWhole) {
  Cloud cloud = noise_and_outliers();
  for (Vec3f& normal : cloud.normals) normal = -normal;
  expect_parity(cloud, {{.depth = 8, .iterations = 4}}, 50 * kMegabyte);
}

TEST_F(BlocksOnGpu, SayHowMuchMemoryWouldDo) {
  write_cloud(input_, test::sphere_cloud(60'000, 7));
  try {
    (void)reconstruct_files({input_}, output_, {{.depth = 9}}, scale(4 * kMegabyte));
    FAIL() << "4 MB hold no block";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::over_limit) << error.what();
  }
}

}  // namespace
}  // namespace pointskin
