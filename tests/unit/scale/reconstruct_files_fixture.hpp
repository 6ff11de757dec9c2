// Files reconstructed in blocks and as a whole, and compared.
#pragma once

#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/merge.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/scale.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "support/io_files.hpp"
#include "support/shapes.hpp"
#include "support/thread_ranks.hpp"

namespace pointskin::test {

inline constexpr std::int64_t kMegabyte = 1'000'000;

class ReconstructFiles : public testing::Test {
 protected:
  void start(const Cloud& cloud) const { write_cloud(input_, cloud); }

  /// Reconstructs both ways, and compares files and reports.
  void expect_as_whole(const Options& options, std::int64_t memory_bytes) {
    Cloud cloud;
    for (const std::string& input : inputs_) merge_into(cloud, read_cloud(input));
    std::vector<bool> keep;
    for (const Vec3f& n : cloud.normals) keep.push_back(n != Vec3f{});
    const std::int64_t unreadable = cloud.dropped;
    keep_where(cloud, keep);
    Reconstructor reconstructor(Device::cpu(2));
    write_mesh(whole_, reconstructor.reconstruct(cloud, options));
    files_ = reconstruct_files(inputs_, output_, options, scale(memory_bytes));
    EXPECT_TRUE(bytes_of_file(output_) == bytes_of_file(whole_));
    EXPECT_EQ(files_.dropped, unreadable);
    EXPECT_EQ(files_.dropped + files_.without_normal, cloud.dropped);
    expect_report(reconstructor.report());
    EXPECT_EQ(temporary_.file_count(), 0U);
    if (ranks_ > 1) expect_the_same_of_ranks(options, memory_bytes);
  }

  /// With all attributes, in as many blocks and as little memory as a plan says.
  void expect_as_planned(const Cloud& cloud) {
    constexpr std::int64_t kMemory = 80 * kMegabyte;
    start(cloud);
    Options options;
    options.depth = 8;
    options.attributes = true;
    expect_as_whole(options, kMemory);
    const FilesPlan plan = plan_files({input_}, options, scale(kMemory));
    EXPECT_EQ(plan.blocks, files_.blocks);
    EXPECT_GE(plan.memory_bytes, files_.run.device_peak_bytes);
  }

  /// What expect_as_whole() has found.
  void expect_the_same_of_ranks(const Options& options, std::int64_t memory_bytes) const {
    SCOPED_TRACE(std::to_string(ranks_) + " ranks");
    const std::string output = folder_.file("ranks.ply");
    const std::vector<FilesReport> reports = reconstruct_as_ranks(output, options, scale(memory_bytes));
    EXPECT_TRUE(bytes_of_file(output) == bytes_of_file(whole_));
    EXPECT_EQ(temporary_.file_count(), 0U);
    for (const FilesReport& report : reports) {
      EXPECT_GE(report.blocks, ranks_);
      EXPECT_EQ(report.triangles, files_.triangles);
      EXPECT_EQ(report.vertices, files_.vertices);
      EXPECT_EQ(report.attributes, files_.attributes);
      EXPECT_EQ(report.run.isovalue, files_.run.isovalue);
      EXPECT_EQ(report.run.nodes, files_.run.nodes);
      EXPECT_EQ(report.run.normals_done, files_.run.normals_done);
      EXPECT_EQ(report.run.strays, files_.run.strays);
      EXPECT_EQ(report.run.pieces.pieces_removed, files_.run.pieces.pieces_removed);
      EXPECT_EQ(report.run.trim.triangles_split, files_.run.trim.triangles_split);
      ASSERT_EQ(report.run.warnings.size(), files_.run.warnings.size());
      for (std::size_t i = 0; i < report.run.warnings.size(); ++i)
        EXPECT_EQ(report.run.warnings[i].text, files_.run.warnings[i].text);
    }
  }

  /// @returns what each of the ranks reports
  [[nodiscard]] std::vector<FilesReport> reconstruct_as_ranks(const std::string& output, const Options& options,
                                                              const ScaleOptions& scale) const {
    std::vector<FilesReport> reports(static_cast<std::size_t>(ranks_));
    run_as_ranks(ranks_, [&](Ranks& ranks) {
      ScaleOptions own = scale;
      own.threads = 1;
      own.ranks = &ranks;
      reports[static_cast<std::size_t>(ranks.rank())] = reconstruct_files(inputs_, output, options, own);
    });
    return reports;
  }

  void expect_report(const RunReport& whole) const {
    const RunReport& blocks = files_.run;
    ASSERT_EQ(blocks.warnings.size(), whole.warnings.size());
    for (std::size_t i = 0; i < whole.warnings.size(); ++i) EXPECT_EQ(blocks.warnings[i].text, whole.warnings[i].text);
    EXPECT_EQ(blocks.normals_done, whole.normals_done);
    EXPECT_EQ(blocks.points, whole.points);
    EXPECT_EQ(blocks.fits, whole.fits);
    EXPECT_EQ(blocks.pieces.pieces, whole.pieces.pieces);
    EXPECT_EQ(blocks.pieces.pieces_removed, whole.pieces.pieces_removed);
    EXPECT_EQ(blocks.pieces.triangles_removed, whole.pieces.triangles_removed);
    expect_trim(whole.trim);
    EXPECT_EQ(blocks.strays, whole.strays);
    EXPECT_EQ(blocks.farthest_strays, whole.farthest_strays);
    EXPECT_EQ(blocks.depth, whole.depth);
    EXPECT_EQ(blocks.nodes, whole.nodes);
    EXPECT_EQ(blocks.isovalue, whole.isovalue);
    ASSERT_EQ(blocks.levels.size(), whole.levels.size());
    for (std::size_t d = 0; d < whole.levels.size(); ++d) {
      EXPECT_EQ(blocks.levels[d].depth, whole.levels[d].depth);
      EXPECT_EQ(blocks.levels[d].nodes, whole.levels[d].nodes) << "depth " << d;
      EXPECT_EQ(blocks.levels[d].iterations, whole.levels[d].iterations) << "depth " << d;
    }
  }

  void expect_trim(const TrimReport& whole) const {
    const TrimReport& blocks = files_.run.trim;
    EXPECT_EQ(blocks.quantile, whole.quantile);
    EXPECT_EQ(blocks.density, whole.density);
    EXPECT_EQ(blocks.area_before, whole.area_before);
    EXPECT_EQ(blocks.area_removed, whole.area_removed);
    EXPECT_EQ(blocks.triangles_before, whole.triangles_before);
    EXPECT_EQ(blocks.triangles_removed, whole.triangles_removed);
    EXPECT_EQ(blocks.triangles_split, whole.triangles_split);
    EXPECT_EQ(blocks.islands_removed, whole.islands_removed);
    EXPECT_EQ(blocks.holes_filled, whole.holes_filled);
  }

  void expect_error(ErrorCode code, const std::string& says, const std::function<void()>& work) const {
    const std::string before = bytes_of_file(output_);
    try {
      work();
      FAIL() << says;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
    EXPECT_EQ(bytes_of_file(output_), before);
    EXPECT_EQ(temporary_.file_count(), 0U);
  }

  [[nodiscard]] ScaleOptions scale(std::int64_t memory_bytes) const {
    ScaleOptions scale;
    scale.max_memory_bytes = memory_bytes;
    scale.threads = 2;
    scale.temp_folder = temporary_.file("");
    return scale;
  }
  void reconstruct(const Options& options, std::int64_t memory_bytes = 100 * kMegabyte) const {
    (void)reconstruct_files(inputs_, output_, options, scale(memory_bytes));
  }
  /// A writer refuses what is not finite.
  void make_first_coordinate_nan() const {
    std::string bytes = bytes_of_file(input_);
    const std::string end = "end_header\n";
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(bytes.data() + bytes.find(end) + end.size(), &kNan, sizeof kNan);
    std::ofstream(input_, std::ios::binary) << bytes;
  }
  void write_old_output() const { std::ofstream(output_) << "what was there"; }

  TemporaryFolder folder_, temporary_;
  std::string input_ = folder_.file("cloud.ply"), output_ = folder_.file("blocks.ply"),
              whole_ = folder_.file("whole.ply");
  std::vector<std::string> inputs_{input_};
  FilesReport files_;
  int ranks_ = 1;  ///< that then do the same
};

inline Options at_depth(int depth) {
  Options options;
  options.depth = depth;
  return options;
}

/// Names that the mesh has itself, values that some points or all lack, and more than share a pass.
inline Cloud with_attributes(Cloud cloud) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  Random random(17);
  std::vector<std::uint8_t> colours[3];
  std::vector<float> density, like_it, nothing;
  std::vector<double> time;
  std::vector<std::uint16_t> intensity;
  for (const Vec3f& p : cloud.positions) {
    for (auto& colour : colours) colour.push_back(static_cast<std::uint8_t>(random.below(256)));
    density.push_back(p.x > 0 ? p.y : kNone);
    like_it.push_back(p.x > 0 ? p.z : kNone);
    nothing.push_back(kNone);
    time.push_back(1e9 * random.unit());
    intensity.push_back(static_cast<std::uint16_t>(random.below(1 << 16)));
  }
  cloud.attributes = {{"red", colours[0]},      {"green", colours[1]}, {"blue", colours[2]}, {"time", time},
                      {"intensity", intensity}, {"density", density},  {"like_it", like_it}, {"nothing", nothing}};
  return cloud;
}

/// Labels of several types, in front of what is averaged, between it, and after it.
inline Cloud with_labels(Cloud cloud) {
  Random random(19);
  std::vector<std::int32_t> segment;
  std::vector<std::uint8_t> red, label;
  std::vector<float> heat;
  std::vector<std::uint16_t> object;
  for (const Vec3f& p : cloud.positions) {
    segment.push_back(static_cast<std::int32_t>(random.below(1 << 30)) - (1 << 29));
    red.push_back(static_cast<std::uint8_t>(random.below(256)));
    label.push_back(static_cast<std::uint8_t>(random.below(256)));
    heat.push_back(p.y);
    object.push_back(static_cast<std::uint16_t>(random.below(1 << 16)));
  }
  cloud.attributes = {{"segment", segment}, {"red", red}, {"label", label}, {"heat", heat}, {"object", object}};
  return cloud;
}

/// A sphere with a hole, and one in the middle of nowhere.
inline Cloud open_cloud() {
  Cloud cloud = sphere_cloud(40000, 14);
  std::vector<bool> keep;
  for (const Vec3f& p : cloud.positions) keep.push_back(p.z < 0.6F && (p.x < 0.8F || p.y > 0));
  keep_where(cloud, keep);
  append(cloud, translated(scaled(sphere_cloud(1000, 7), 0.2F), {1.4F, 1.4F, 1.4F}));
  return cloud;
}

}  // namespace pointskin::test
