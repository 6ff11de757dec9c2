// Bad input, bad places, bad devices: a defined exit code, one line, and nothing written.
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <pointskin/device.hpp>
#include <pointskin/error.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

class BadInput : public testing::Test {
 protected:
  /// Runs a reconstruction of `bytes` at depth 5 with `more` arguments.
  Result reconstruct(const std::string& bytes, const std::vector<std::string>& more = {}, const char* name = "in.ply") {
    write_file(folder_ / name, bytes);
    std::vector<std::string> args = {"reconstruct", folder_ / name, "-o", folder_ / "out.ply", "--depth", "5"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  void expect_failure(const Result& result, const std::set<int>& codes) {
    EXPECT_TRUE(codes.contains(result.exit_code)) << result.exit_code << " " << result.signal << " " << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_EQ(result.out, "");
    for (const std::string& name : folder_.names()) EXPECT_TRUE(name.starts_with("in.")) << "left behind: " << name;
  }

  TemporaryFolder folder_;
};

TEST_F(BadInput, EmptyFileIsInvalid) {
  expect_failure(reconstruct(""), {3});
  expect_failure(reconstruct("", {}, "in.xyz"), {3});
}

TEST_F(BadInput, MissingFileIsInvalidAndNamed) {
  const Result result = pointskin_run({"reconstruct", folder_ / "nowhere.ply", "-o", folder_ / "out.ply"});
  expect_failure(result, {3});
  EXPECT_NE(result.err.find("nowhere.ply"), std::string::npos) << result.err;
}

TEST_F(BadInput, NameWithControlCharactersStaysOneHarmlessLine) {
  const Result result = pointskin_run({"reconstruct", "a\nb\x1b[31m.ply", "-o", folder_ / "out.ply"});
  expect_failure(result, {3});
  EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
}

TEST_F(BadInput, FolderAsInputIsInvalid) {
  expect_failure(pointskin_run({"reconstruct", folder_.path(), "-o", folder_ / "out.ply"}), {3});
}

TEST_F(BadInput, HeaderThatPromisesATrillionVerticesIsRefusedAtOnce) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const Result result = reconstruct(std::string("ply\nformat ") + format +
                                      " 1.0\nelement vertex 1000000000000\nproperty float x\nproperty float y\n"
                                      "property float z\nend_header\n0 0 0\n");
    expect_failure(result, {3});
    EXPECT_LT(result.seconds, 5) << format;
  }
}

TEST_F(BadInput, TruncatedFileIsInvalid) {
  const std::string whole = ply_bytes(sphere(100));
  expect_failure(reconstruct(whole.substr(0, whole.size() - 7)), {3});
  expect_failure(reconstruct(whole.substr(0, 60)), {3});
}

TEST_F(BadInput, GarbageIsInvalid) {
  expect_failure(reconstruct(std::string("ply\nformat sideways 1.0\nend_header\n")), {3});
  expect_failure(reconstruct("these are no numbers\n", {}, "in.xyz"), {3});
  std::string noise;
  for (unsigned i = 0, x = 1; i < 5000; ++i, x = x * 1664525U + 1013904223U) noise += static_cast<char>(x >> 24);
  expect_failure(reconstruct(noise), {3});
}

TEST_F(BadInput, NoNormalsIsExitFourAndSaysWhichFile) {
  const Result result = reconstruct(ply_bytes(sphere(100), false));
  expect_failure(result, {4});
  EXPECT_NE(result.err.find("in.ply"), std::string::npos) << result.err;
}

TEST_F(BadInput, AllZeroNormalsIsExitFour) {
  std::vector<Sample> samples = sphere(100);
  for (Sample& s : samples) s.normal = {};
  expect_failure(reconstruct(ply_bytes(samples)), {4});
}

TEST_F(BadInput, AllPointsNotFiniteIsInvalid) {
  std::vector<Sample> samples = sphere(100);
  for (Sample& s : samples) s.position.y = std::numeric_limits<float>::quiet_NaN();
  expect_failure(reconstruct(ply_bytes(samples)), {3});
}

TEST_F(BadInput, NoPointsAtAllIsInvalidOrEmpty) { expect_failure(reconstruct(ply_bytes({})), {3, 5}); }

/// Accepts a mesh or an empty result, but no crash.
TEST_F(BadInput, OnePointAndIdenticalPointsEndDefined) {
  const std::vector<std::vector<Sample>> clouds = {sphere(1), std::vector<Sample>(1000, sphere(1)[0])};
  for (const std::vector<Sample>& cloud : clouds) {
    const Result result = reconstruct(ply_bytes(cloud));
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 5) << result.exit_code << " " << result.err;
    EXPECT_EQ(std::filesystem::exists(folder_ / "out.ply"), result.exit_code == 0);
    std::filesystem::remove(folder_ / "out.ply");
  }
}

TEST_F(BadInput, HugeAndTinyCoordinatesEndDefined) {
  for (const float size : {1e30F, 1e-30F, 3e38F}) {
    std::vector<Sample> samples = sphere(500);
    for (Sample& s : samples) s.position = {s.position.x * size, s.position.y * size, s.position.z * size};
    const Result result = reconstruct(ply_bytes(samples));
    EXPECT_EQ(result.signal, 0) << size;
    EXPECT_TRUE(std::set<int>({0, 3, 5}).contains(result.exit_code)) << size << " " << result.err;
    std::filesystem::remove(folder_ / "out.ply");
  }
}

TEST_F(BadInput, SomeBadPointsAreDroppedAndCounted) {
  std::vector<Sample> samples = sphere(2000);
  samples[7].position.x = std::numeric_limits<float>::infinity();
  samples[70].normal = {};
  samples[71].normal = {};
  const Result result = reconstruct(ply_bytes(samples));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("warning: 1 points were dropped"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("warning: 2 points were dropped"), std::string::npos) << result.err;
}

TEST_F(BadInput, CorruptScanFromTheWildIsInvalid) {
  const std::string path = POINTSKIN_SOURCE_DIR "/../shared/data/corrupt_pond.ply";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  expect_failure(pointskin_run({"reconstruct", path, "-o", folder_ / "out.ply", "--depth", "5"}), {3});
}

TEST_F(BadInput, MissingOrReadOnlyOutputFolderIsFoundBeforeReading) {
  for (const std::string& output : {folder_ / "no/such/out.ply", std::string("/proc/out.ply")}) {
    expect_failure(pointskin_run({"reconstruct", "missing.ply", "-o", output}), {8});
  }
  expect_failure(pointskin_run({"convert", "missing.ply", folder_ / "no/out.ply"}), {8});
  expect_failure(pointskin_run({"render", "missing.ply", "-o", folder_ / "no/out.png"}), {8});
  expect_failure(
      pointskin_run({"reconstruct", "missing.ply", "-o", folder_ / "o.ply", "--report", folder_ / "no/r.json"}), {8});
}

TEST_F(BadInput, FolderAsOutputIsNotWritten) {
  const std::string output = folder_ / "in.folder.ply";
  std::filesystem::create_directory(output);
  expect_failure(pointskin_run({"reconstruct", "missing.ply", "-o", output}), {8});
}

TEST_F(BadInput, CudaWithoutAGpuIsFoundBeforeReading) {
  try {
    Device::cuda(0);
    GTEST_SKIP() << "a GPU is present";
  } catch (const Error&) {
    expect_failure(pointskin_run({"reconstruct", "missing.ply", "-o", folder_ / "o.ply", "--device", "cuda"}), {7});
    expect_failure(pointskin_run({"reconstruct", "missing.ply", "-o", folder_ / "o.ply", "--device", "cuda:3"}), {7});
  }
}

TEST_F(BadInput, EstimateAboveTheMemoryLimitIsRefused) {
  const Result result = reconstruct(ply_bytes(sphere(20000)), {"--max-memory", "1M"});
  expect_failure(result, {6});
  EXPECT_NE(result.err.find("--max-memory"), std::string::npos) << result.err;
}

TEST_F(BadInput, ReadingCommandsRefuseBadFilesToo) {
  write_file(folder_ / "in.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  for (const char* command : {"info", "check"}) expect_failure(pointskin_run({command, folder_ / "in.ply"}), {3});
  expect_failure(pointskin_run({"compare", folder_ / "in.ply", folder_ / "in.ply"}), {3});
  expect_failure(pointskin_run({"convert", folder_ / "in.ply", folder_ / "out.obj"}), {3});
  expect_failure(pointskin_run({"render", folder_ / "in.ply", "-o", folder_ / "out.png"}), {3});
}

TEST_F(BadInput, FaceThatNamesAMissingVertexIsInvalid) {
  std::string mesh = cube_mesh_ply(1);
  mesh.replace(mesh.rfind("3 "), std::string::npos, "3 0 1 99\n");
  write_file(folder_ / "in.ply", mesh);
  expect_failure(pointskin_run({"check", folder_ / "in.ply"}), {3});
}

}  // namespace
}  // namespace pointskin::test
