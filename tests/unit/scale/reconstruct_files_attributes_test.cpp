// Attributes of files reconstructed in blocks, against the whole in memory.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/scale.hpp>

#include <cstddef>
#include <cstdint>
#include <numeric>
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
  expect_as_planned(cloud);
}

TEST_F(ReconstructFiles, ArePlannedWithManyLabels) {
  Cloud cloud = torus_cloud(60000, 1);
  for (int i = 0; i < 10; ++i)
    cloud.attributes.push_back({"label_" + std::to_string(i), std::vector<std::int32_t>(cloud.positions.size(), i)});
  expect_as_planned(cloud);
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

TEST_F(ReconstructFiles, KeepsLabels) {
  ranks_ = 3;
  start(with_labels(torus_cloud(60000, 1)));
  Options options = at_depth(8);
  options.attributes = options.density = options.confidence = true;
  expect_as_whole(options, 70 * kMegabyte);
  EXPECT_GT(files_.blocks, 1);
  EXPECT_EQ(files_.attributes, (std::vector<std::string>{"segment", "red", "label", "heat", "object"}));
}

/// Labels alone, whose nearest samples are on the other side of a hole, or of the cube.
TEST_F(ReconstructFiles, KeepsLabelsFarFromAllSamples) {
  ranks_ = 3;
  Cloud cloud = open_cloud();
  Random random(20);
  std::vector<std::int32_t> label;
  for (std::int64_t i = 0; i < cloud.size(); ++i) label.push_back(static_cast<std::int32_t>(random.below(1 << 30)));
  cloud.attributes = {{"label", label}};
  start(cloud);
  Options options = at_depth(8);
  options.attributes = true;
  options.iterations = 1;  // the narrowest ring
  expect_as_whole(options, 40 * kMegabyte);
  EXPECT_GT(files_.blocks, 1);
  options.trim = 0.02;
  expect_as_whole(options, 40 * kMegabyte);
  EXPECT_GT(files_.blocks, 1);
  EXPECT_GT(files_.run.trim.triangles_split, 0);
}

/// Samples as near as each other, of which the first in the order of the octree counts.
TEST_F(ReconstructFiles, KeepsLabelsOfPointsOnAGrid) {
  ranks_ = 3;
  Cloud cloud;
  for (int x = 0; x < 64; ++x)
    for (int y = 0; y < 64; ++y)
      if (x < 20 || x > 40 || y < 20 || y > 40)
        for (int twice = 0; twice < 2; ++twice) {
          cloud.positions.push_back({static_cast<float>(x) / 64, static_cast<float>(y) / 64, 0});
          cloud.normals.push_back({0, 0, 1});
        }
  std::vector<std::int32_t> label(cloud.positions.size());
  std::iota(label.begin(), label.end(), 0);
  cloud.attributes = {{"label", label}};
  start(cloud);
  Options options = at_depth(8);
  options.attributes = true;
  expect_as_whole(options, 0);
}

}  // namespace
}  // namespace pointskin::test
