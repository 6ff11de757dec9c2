// Attributes of files reconstructed in blocks, against the whole in memory.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/scale.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "unit/scale/reconstruct_files_fixture.hpp"

namespace pointskin::test {
namespace {

TEST_F(ReconstructFiles, KeepsAttributes) {
  start(with_attributes(torus_cloud(60000, 1)));
  Options options = at_depth(8);
  options.attributes = true;
  for (const bool also : {false, true}) {
    options.density = options.confidence = also;
    expect_as_whole(options, 70 * kMegabyte);
    EXPECT_GT(files_.blocks, 1);
    EXPECT_EQ(files_.attributes, (std::vector<std::string>{"red", "green", "blue", "time", "intensity",
                                                           also ? "input_density" : "density", "like_it"}));
  }
}

TEST_F(ReconstructFiles, KeepsAttributesOfACut) {
  ranks_ = 3;
  Cloud cloud = sphere_cloud(60000, 2);
  std::vector<bool> keep;
  for (const Vec3f& p : cloud.positions) keep.push_back(p.z < 0.5F);
  keep_where(cloud, keep);
  start(with_attributes(cloud));
  Options options = at_depth(8);
  options.attributes = options.density = true;
  options.trim = 0.02;
  expect_as_whole(options, 80 * kMegabyte);
  EXPECT_GT(files_.blocks, 1);
  EXPECT_GT(files_.run.trim.triangles_split, 0);
}

TEST_F(ReconstructFiles, KeepsAttributesAroundOutliersAndStrays) {
  Cloud cloud = torus_cloud(60000, 3);
  append(cloud, scaled(jittered(box_cloud(60, 5), 6, 0.4), 1.5F));
  cloud.positions.push_back({300, 0, 0});
  cloud.normals.push_back({1, 0, 0});
  start(with_attributes(cloud));
  Options options = at_depth(8);
  options.attributes = true;
  expect_as_whole(options, 60 * kMegabyte);
  EXPECT_GT(files_.blocks, 1);
  EXPECT_GT(files_.run.strays, 0);
  EXPECT_EQ(files_.run.fits, 2);
}

/// One iteration has the narrowest ring; a cut without normals has their column after those of the attributes.
TEST_F(ReconstructFiles, KeepsAttributesWithoutNormals) {
  start(with_attributes(torus_cloud(60000, 1)));
  Options options = at_depth(8);
  options.attributes = true;
  options.normals = false;
  options.iterations = 1;
  for (const double trim : {0.0, 0.05}) {
    options.trim = trim;
    expect_as_whole(options, 60 * kMegabyte);
    EXPECT_GT(files_.blocks, 1);
  }
}

TEST_F(ReconstructFiles, KeepsAttributesOfTurnedNormals) {
  Cloud cloud = torus_cloud(60000, 1);
  for (Vec3f& n : cloud.normals) n = n * -1.0F;
  start(with_attributes(cloud));
  Options options = at_depth(8);
  options.attributes = true;
  expect_as_whole(options, 60 * kMegabyte);
  EXPECT_EQ(files_.run.normals_done, NormalsDone::turned);
}

/// Ten of 8 bytes take more at the vertices than at the nodes.
TEST_F(ReconstructFiles, ArePlannedWithManyAttributes) {
  Cloud cloud = torus_cloud(60000, 1);
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    std::vector<double> values(cloud.positions.size());
    for (double& value : values) value = random.unit();
    cloud.attributes.push_back({"value_" + std::to_string(i), values});
  }
  start(cloud);
  Options options = at_depth(8);
  options.attributes = true;
  expect_as_whole(options, 80 * kMegabyte);
  const FilesPlan plan = plan_files({input_}, options, scale(80 * kMegabyte));
  EXPECT_EQ(plan.blocks, files_.blocks);
  EXPECT_GE(plan.memory_bytes, files_.run.device_peak_bytes);
}

TEST_F(ReconstructFiles, KeepsColoursAlone) {
  start(with_attributes(torus_cloud(60000, 1)));
  Options options = at_depth(8);
  options.attributes = true;
  ScaleOptions in_blocks = scale(50 * kMegabyte);
  in_blocks.only_colours = true;
  files_ = reconstruct_files({input_}, output_, options, in_blocks);
  EXPECT_EQ(files_.attributes, (std::vector<std::string>{"red", "green", "blue"}));
  Cloud cloud = read_cloud(input_);
  cloud.attributes.resize(3);
  write_mesh(whole_, Reconstructor(Device::cpu(2)).reconstruct(cloud, options));
  EXPECT_TRUE(bytes_of_file(output_) == bytes_of_file(whole_));
}

TEST_F(ReconstructFiles, RefusesLabels) {
  Cloud cloud = sphere_cloud(2000, 8);
  cloud.attributes = {{"heat", std::vector<float>(2000, 1)}, {"class", std::vector<std::int32_t>(2000, 3)}};
  start(cloud);
  write_old_output();
  Options options = at_depth(7);
  options.attributes = true;
  EXPECT_EQ(missing_in_blocks({input_}, options), (std::vector<std::string>{"labels of points such as class"}));
  expect_error(ErrorCode::usage, "labels of points such as class", [&] { reconstruct(options); });
  ScaleOptions colours = scale(0);
  colours.only_colours = true;
  EXPECT_TRUE(missing_in_blocks({input_}, options, colours).empty());
  options.attributes = false;
  EXPECT_TRUE(missing_in_blocks({input_}, options).empty());
}

}  // namespace
}  // namespace pointskin::test
