// Small input files that the tests make themselves.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <pointskin/vector.hpp>

namespace pointskin::test {

/// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// Path of `name` inside.
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::string path() const { return path_.string(); }

  /// Names of the files inside, sorted.
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

/// A point with its normal.
struct Sample {
  Vec3f position, normal;
};

/// `count` points spread evenly over the sphere of radius 1 about `centre`, normals outward (a Fibonacci spiral).
std::vector<Sample> sphere(int count, const Vec3f& centre = {});

/// The same samples in another order, which `seed` chooses.
std::vector<Sample> shuffled(std::vector<Sample> samples, std::uint32_t seed);

/// Binary little-endian PLY of floats, with or without normals.
std::string ply_bytes(const std::vector<Sample>& samples, bool with_normals = true);

/// ASCII PLY of a closed, outward-facing box grid: the surface of a cube with n x n squares a face.
std::string cube_mesh_ply(int n);

std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& bytes);

}  // namespace pointskin::test
