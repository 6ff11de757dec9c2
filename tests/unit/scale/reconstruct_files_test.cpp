// Files reconstructed in blocks, against the whole in memory.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/scale.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <set>
#include <string>
#include <vector>

#include "unit/scale/reconstruct_files_fixture.hpp"

namespace pointskin::test {
namespace {

TEST_F(ReconstructFiles, WritesTheFileOfTheWhole) {
  ranks_ = 3;
  Cloud cloud = torus_cloud(60000, 1);
  for (std::size_t i = 0; i < 50; ++i) cloud.normals[100 * i + 1] = {};
  start(cloud);
  make_first_coordinate_nan();
  expect_as_whole(at_depth(8), 50 * kMegabyte);
  EXPECT_GT(files_.blocks, 1);
  EXPECT_EQ(files_.without_normal, 50);
  EXPECT_EQ(files_.dropped, 1);
  expect_as_whole(at_depth(7), 0);
  EXPECT_EQ(files_.blocks, 1);
}

/// Scans in files of their own, far away, one of them text.
TEST_F(ReconstructFiles, MergesSeveralFiles) {
  ranks_ = 3;
  const Cloud cloud = with_attributes(torus_cloud(60000, 1));
  const auto part = [&](int number, float at) {
    std::vector<bool> keep;
    for (const Vec3f& p : cloud.positions) keep.push_back(number == (p.x < -0.3F ? 0 : p.x < 0.4F ? 1 : 2));
    Cloud some = cloud;
    keep_where(some, keep);
    some.dropped = 0;
    some.origin = {3e5, -2e6 + at, 0};
    for (Vec3f& p : some.positions) p.y -= at;
    return some;
  };
  start(part(0, 0));
  inputs_ = {input_, folder_.file("middle.ply"), folder_.file("last.csv")};
  write_cloud(inputs_[1], part(1, 1000));
  std::ofstream text(inputs_[2]);
  text << "x,y,z,nx,ny,nz,red,green,blue,height\n" << std::setprecision(17);
  const Cloud last = part(2, 0);
  for (std::size_t i = 0; i < last.positions.size(); ++i) {
    const Vec3f &p = last.positions[i], &n = last.normals[i];
    text << 3e5 + p.x << ',' << -2e6 + p.y << ',' << p.z << ',' << n.x << ',' << n.y << ',' << n.z << ',' << i % 256
         << ",7,0," << p.z << '\n';
  }
  text.close();
  Options options = at_depth(8);
  expect_as_whole(options, 50 * kMegabyte);
  EXPECT_GT(files_.blocks, 1);
  options.attributes = true;
  EXPECT_EQ(missing_in_blocks(inputs_, options),
            std::vector<std::string>{"integers that not all files have, such as intensity"});
  ScaleOptions colours = scale(50 * kMegabyte);
  colours.only_colours = true;
  EXPECT_TRUE(missing_in_blocks(inputs_, options, colours).empty());
  inputs_.resize(2);
  expect_as_whole(options, 50 * kMegabyte);
}

/// Few points at a great depth: their octree needs more than what blocks are planned for.
TEST_F(ReconstructFiles, CutsBlocksThatNeedMoreThanPlanned) {
  start(box_cloud(900, 3));
  Options options = at_depth(10);
  options.point_normals = PointNormals::given;  // the whole repairs those of so few points
  EXPECT_EQ(plan_files({input_}, options, scale(60 * kMegabyte)).blocks, 1);
  expect_as_whole(options, 60 * kMegabyte);
  EXPECT_EQ(files_.blocks, 2);
}

TEST_F(ReconstructFiles, IsPlannedAsItIsDone) {
  start(torus_cloud(60000, 1));
  write_old_output();
  for (const std::int64_t megabytes : {50, 150}) {
    const FilesPlan plan = plan_files({input_}, at_depth(8), scale(megabytes * kMegabyte));
    EXPECT_EQ(bytes_of_file(output_), "what was there");
    EXPECT_EQ(temporary_.file_count(), 0U);
    const FilesReport files =
        reconstruct_files({input_}, folder_.file("other.ply"), at_depth(8), scale(megabytes * kMegabyte));
    EXPECT_EQ(plan.points, 60000);
    EXPECT_EQ(plan.blocks, files.blocks);
    EXPECT_EQ(plan.coarse_level, files.coarse_level);
    EXPECT_GE(plan.overlap, 1);
    EXPECT_LE(plan.memory_bytes, megabytes * kMegabyte);
    EXPECT_GE(plan.memory_bytes, files.run.device_peak_bytes);
    EXPECT_GE(plan.temp_bytes, 80 * plan.points);
  }
  expect_error(ErrorCode::usage, "weakness", [&] {
    Options options = at_depth(8);
    options.weakness = true;
    (void)plan_files({input_}, options, scale(50 * kMegabyte));
  });
}

/// What several files have is what one has: put together, and vertices that are the same made one again.
TEST_F(ReconstructFiles, WritesAFileForEachBlock) {
  ranks_ = 3;
  start(with_attributes(torus_cloud(60000, 1)));
  ScaleOptions in_files = scale(70 * kMegabyte);
  in_files.split = true;
  Options options = at_depth(8);
  options.density = options.attributes = true;
  using Corner = std::array<double, 9>;  // position, normal, red, time, density
  using Corners = std::multiset<std::array<Corner, 3>>;
  const auto corners_of = [](const Mesh& mesh, Corners& all) {
    const std::vector<std::uint8_t>& red = mesh.attributes.at(0).values.as<std::uint8_t>();
    const std::vector<double>& time = mesh.attributes.at(3).values.as<double>();
    const std::vector<float>& density = mesh.attributes.back().values.as<float>();
    const auto corner = [&](std::int32_t vertex) {
      const auto v = static_cast<std::size_t>(vertex);
      const Vec3f &p = mesh.vertices[v], &n = mesh.normals[v];
      return Corner{p.x, p.y, p.z, n.x, n.y, n.z, static_cast<double>(red[v]), time[v], density[v]};
    };
    for (const Triangle& t : mesh.triangles)
      all.insert(std::array<Corner, 3>{corner(t[0]), corner(t[1]), corner(t[2])});
  };
  Corners whole;
  corners_of(Reconstructor(Device::cpu(2)).reconstruct(read_cloud(input_), options), whole);
  const auto expect_parts = [&](const FilesReport& report, const std::string& name) {
    EXPECT_FALSE(std::filesystem::exists(folder_.file(name + ".ply")));
    EXPECT_GT(report.outputs.size(), 1U);
    EXPECT_LE(std::ssize(report.outputs), report.blocks);
    Corners parts;
    for (std::size_t i = 0; i < report.outputs.size(); ++i) {
      EXPECT_EQ(report.outputs[i], folder_.file(name + "_000" + std::to_string(i) + ".ply"));
      const Mesh mesh = read_mesh(report.outputs[i]);
      std::vector<bool> is_used(mesh.vertices.size(), false);
      for (const Triangle& t : mesh.triangles)
        for (const std::int32_t v : t) is_used[static_cast<std::size_t>(v)] = true;
      EXPECT_TRUE(std::all_of(is_used.begin(), is_used.end(), [](bool used) { return used; })) << i;
      corners_of(mesh, parts);
    }
    EXPECT_TRUE(parts == whole);
    EXPECT_EQ(std::ssize(parts), report.triangles);
  };
  expect_parts(reconstruct_files({input_}, output_, options, in_files), "blocks");
  for (const FilesReport& report : reconstruct_as_ranks(folder_.file("ranks.ply"), options, in_files))
    expect_parts(report, "ranks");
  EXPECT_EQ(temporary_.file_count(), 0U);
}

/// A folder in the way of the second file.
TEST_F(ReconstructFiles, KeepsOldFilesWhereOneCannotBeWritten) {
  start(torus_cloud(60000, 1));
  ScaleOptions in_files = scale(50 * kMegabyte);
  in_files.split = true;
  test::make_file(folder_.file("blocks_0000.ply"), "old");
  const std::size_t count = folder_.file_count() + 1;  // and the folder
  std::filesystem::create_directory(folder_.file("blocks_0001.ply"));
  expect_error(ErrorCode::output_not_written, "blocks_0001.ply",
               [&] { (void)reconstruct_files({input_}, output_, at_depth(8), in_files); });
  EXPECT_EQ(test::bytes_of_file(folder_.file("blocks_0000.ply")), "old");
  EXPECT_EQ(folder_.file_count(), count);
}

TEST_F(ReconstructFiles, KeepsTheOriginOfCoordinatesThatAreFar) {
  start(translated(sphere_cloud(20000, 2), {3e5F, -2e5F, 0}));
  expect_as_whole(at_depth(7), 40 * kMegabyte);
}

TEST_F(ReconstructFiles, TurnsNormalsThatPointInwards) {
  start(flipped(sphere_cloud(20000, 3)));
  expect_as_whole(at_depth(7), 40 * kMegabyte);
  EXPECT_EQ(files_.run.normals_done, NormalsDone::turned);
  Options options = at_depth(7);
  options.point_normals = PointNormals::given;
  expect_as_whole(options, 40 * kMegabyte);
  EXPECT_EQ(files_.run.normals_done, NormalsDone::kept);
}

TEST_F(ReconstructFiles, LeavesStraysOut) {
  ranks_ = 3;
  Cloud cloud = sphere_cloud(20000, 4);
  for (const float far : {40.0F, 50.0F}) {
    cloud.positions.push_back({far, 0, far});
    cloud.normals.push_back({0, 0, 1});
  }
  start(cloud);
  expect_as_whole(at_depth(7), 40 * kMegabyte);
  EXPECT_EQ(files_.run.strays, 2);
  Options options = at_depth(8);
  options.keep_strays = true;
  expect_as_whole(options, 40 * kMegabyte);
}

TEST_F(ReconstructFiles, MakesTheCubeForInliersAsTheWholeDoes) {
  ranks_ = 3;
  Cloud cloud = sphere_cloud(20000, 5);
  append(cloud, scaled(jittered(box_cloud(300, 6), 7, 0.5), 3));
  start(cloud);
  Options options = at_depth(8);
  options.point_normals = PointNormals::given;
  expect_as_whole(options, 60 * kMegabyte);
  EXPECT_EQ(files_.run.fits, 2);
  EXPECT_GT(files_.run.pieces.pieces, 0);
}

TEST_F(ReconstructFiles, LeavesOutPiecesAndWritesTheDensity) {
  Cloud cloud = torus_cloud(20000, 13);
  append(cloud, translated(scaled(sphere_cloud(1000, 7), 0.2F), {2, 2, 2}));
  start(cloud);
  Options options = at_depth(8);
  options.density = true;
  expect_as_whole(options, 60 * kMegabyte);
  options.largest = true;
  options.normals = false;
  expect_as_whole(options, 60 * kMegabyte);
  EXPECT_EQ(files_.run.pieces.pieces_removed, 1);
  options.largest = false;
  options.min_component = 0.9;
  expect_as_whole(options, 60 * kMegabyte);
  options.min_component = 1e9;
  write_old_output();
  expect_error(ErrorCode::empty_result, "min-component", [&] { reconstruct(options); });
}

TEST_F(ReconstructFiles, ObeysBoundariesAndIsovalues) {
  Cloud cloud = sphere_cloud(40000, 14);
  std::vector<bool> keep;
  for (const Vec3f& p : cloud.positions) keep.push_back(p.x > -0.5F && p.z < 0.7F);
  keep_where(cloud, keep);  // the surface runs into the faces of the cube
  start(cloud);
  Options options = at_depth(8);
  options.boundary = Boundary::dirichlet;
  expect_as_whole(options, 50 * kMegabyte);
  options.boundary = Boundary::free;
  options.domain_faces = DomainFaces::open;
  expect_as_whole(options, 50 * kMegabyte);
  EXPECT_GT(files_.blocks, 1);
  options.isovalue = 0.4;
  expect_as_whole(options, 50 * kMegabyte);
  options.domain_faces = DomainFaces::closed;
  expect_as_whole(options, 50 * kMegabyte);
}

TEST_F(ReconstructFiles, CutsWhereSamplesEnd) {
  start(open_cloud());
  Options options = at_depth(8);
  options.trim = 0.05;
  for (const std::int64_t megabytes : {0, 35}) {
    expect_as_whole(options, megabytes * kMegabyte);
    EXPECT_GT(files_.run.trim.triangles_split, 100);
  }
  EXPECT_GT(files_.blocks, 3);
  options.trim = 0.005;
  options.island_ratio = 0.2;
  expect_as_whole(options, 50 * kMegabyte);
  EXPECT_GT(files_.run.trim.islands_removed, 0);
  options.island_ratio = 0;
  options.density = true;
  options.normals = false;
  options.largest = true;
  expect_as_whole(options, 50 * kMegabyte);
  EXPECT_GT(files_.run.pieces.pieces_removed, 0);
  options.normals = true;
  options.largest = false;
  options.min_component = 500;
  options.boundary = Boundary::dirichlet;
  expect_as_whole(options, 50 * kMegabyte);
}

TEST_F(ReconstructFiles, CutsAmongOutliers) {
  Cloud cloud = open_cloud();
  append(cloud, jittered(box_cloud(300, 6), 7, 0.5));
  start(cloud);
  Options options = at_depth(8);
  options.point_normals = PointNormals::given;
  options.density = true;
  for (const double trim : {0.02, Options::kAutomaticTrim}) {
    options.trim = trim;
    expect_as_whole(options, 46 * kMegabyte);
    EXPECT_GT(files_.blocks, 1);
    EXPECT_GT(files_.run.pieces.pieces, 0);
  }
}

TEST_F(ReconstructFiles, ChoosesWhereToCutAsTheWholeDoes) {
  Options options = at_depth(8);
  options.trim = Options::kAutomaticTrim;
  start(open_cloud());
  expect_as_whole(options, 50 * kMegabyte);
  EXPECT_GT(files_.run.trim.quantile, 0);
  start(torus_cloud(60000, 1));  // closed: nothing is cut
  expect_as_whole(options, 50 * kMegabyte);
  EXPECT_EQ(files_.run.trim.quantile, 0);
  Cloud cut_by_faces = sphere_cloud(40000, 14);
  std::vector<bool> keep;
  for (const Vec3f& p : cut_by_faces.positions) keep.push_back(p.z < -0.3F);
  keep_where(cut_by_faces, keep);  // runs into the faces of the cube
  start(cut_by_faces);
  expect_as_whole(options, 50 * kMegabyte);
  EXPECT_GT(files_.run.trim.quantile, 0);
}

TEST_F(ReconstructFiles, TakesLengthsOfNormalsForConfidence) {
  Options options = at_depth(8);
  options.confidence = true;
  for (const float unit : {1.0F, 1e-20F}) {  // another unit for the sum of the lengths
    Cloud cloud = torus_cloud(60000, 15);
    for (std::size_t i = 0; i < cloud.normals.size(); ++i)
      cloud.normals[i] = cloud.normals[i] * (unit * (0.5F + static_cast<float>(i % 7)));
    start(cloud);
    expect_as_whole(options, 50 * kMegabyte);
    EXPECT_GT(files_.blocks, 1);
  }
}

TEST_F(ReconstructFiles, SaysWhatBlocksCannotDo) {
  start(sphere_cloud(2000, 8));
  write_old_output();
  Options options = at_depth(7);
  options.weakness = true;
  options.point_normals = PointNormals::estimate;
  EXPECT_EQ(missing_in_blocks({input_}, options), (std::vector<std::string>{"making normals", "weakness"}));
  expect_error(ErrorCode::usage, "making normals, weakness", [&] { reconstruct(options); });
  expect_error(ErrorCode::usage, "depth", [&] { reconstruct(at_depth(6)); });
  expect_error(ErrorCode::usage, "files", [&] { (void)reconstruct_files({}, output_, at_depth(7), scale(0)); });
  EXPECT_TRUE(missing_in_blocks({}, at_depth(7)).empty());
  EXPECT_TRUE(missing_in_blocks({input_}, at_depth(7)).empty());
}

TEST_F(ReconstructFiles, NeedsAFileThatCanBeReadInParts) {
  start(sphere_cloud(2000, 9));
  write_old_output();
  EXPECT_TRUE(reads_in_parts(input_));
  const std::string other = folder_.file("cloud.json");
  std::ofstream(other) << "[[0, 0, 0]]\n";
  EXPECT_FALSE(reads_in_parts(other));
  expect_error(ErrorCode::invalid_input, "in parts",
               [&] { (void)reconstruct_files({other}, output_, at_depth(7), scale(0)); });
}

TEST_F(ReconstructFiles, NeedsNormals) {
  Cloud cloud = sphere_cloud(2000, 10);
  cloud.normals.clear();
  start(cloud);
  write_old_output();
  expect_error(ErrorCode::no_normals, "normals", [&] { reconstruct(at_depth(7)); });
}

TEST_F(ReconstructFiles, SaysHowMuchMemoryIsMissing) {
  start(sphere_cloud(20000, 11));
  write_old_output();
  expect_error(ErrorCode::over_limit, "bytes or more", [&] { reconstruct(at_depth(8), kMegabyte); });
}

TEST_F(ReconstructFiles, StopsAtAnyMoment) {
  start(torus_cloud(20000, 12));
  write_old_output();
  int calls = 0;
  Options options = at_depth(7);
  options.progress = [&](const Progress& progress) {
    EXPECT_GE(progress.fraction, 0);
    EXPECT_LE(progress.fraction, 1);
    return ++calls > 0;
  };
  const std::string before = bytes_of_file(output_);
  reconstruct(options, 30 * kMegabyte);
  EXPECT_NE(bytes_of_file(output_), before);
  const int all = calls;
  EXPECT_GT(all, 14);
  for (int stop = 1; stop <= all; stop += 1 + all / 12) {
    calls = 0;
    options.progress = [&](const Progress&) { return ++calls < stop; };
    expect_error(ErrorCode::interrupted, "", [&] { reconstruct(options, 30 * kMegabyte); });
  }
}

}  // namespace
}  // namespace pointskin::test
