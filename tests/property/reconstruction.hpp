// Reconstructions on the CPU, and their comparison byte by byte.
#pragma once

#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "support/attributes.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {

inline Mesh reconstructed(const Cloud& cloud, const Options& options, int threads = 2) {
  return Reconstructor(Device::cpu(threads)).reconstruct(cloud, options);
}

/// A mesh and how it came about.
struct Outcome {
  Mesh mesh;
  RunReport report;
};
inline Outcome run(const Cloud& cloud, const Options& options, int threads = 2) {
  Reconstructor r(Device::cpu(threads));
  Outcome result;
  result.mesh = r.reconstruct(cloud, options);
  result.report = r.report();
  return result;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Vertices, normals, triangles and attributes; the origins are not compared.
inline void expect_same_bytes(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.vertices.size(), b.vertices.size());
  EXPECT_EQ(a.triangles.size(), b.triangles.size());
  EXPECT_TRUE(same_bytes(a.vertices, b.vertices));
  EXPECT_TRUE(same_bytes(a.normals, b.normals));
  EXPECT_TRUE(same_bytes(a.triangles, b.triangles));
  ASSERT_EQ(a.attributes.size(), b.attributes.size());
  for (std::size_t i = 0; i < a.attributes.size(); ++i) {
    EXPECT_EQ(a.attributes[i].name, b.attributes[i].name);
    EXPECT_TRUE(same_bytes(a.attributes[i].values, b.attributes[i].values));
  }
}

/// Code of the Error that `run` throws; none if it returns.
template <class Run>
std::optional<ErrorCode> error_of(const Run& run) {
  try {
    run();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()), "");
    return error.code();
  }
  return std::nullopt;
}

/// A public test cloud of ../shared/data, which is not part of the project; none if it is absent.
inline std::optional<Cloud> shared_cloud(const std::string& name) {
  const std::string path = std::string(POINTSKIN_SOURCE_DIR) + "/../shared/data/" + name + ".ply";
  if (!std::filesystem::exists(path)) return std::nullopt;
  return read_cloud(path);
}

/// Expects the signed distance to the unit sphere, in cells and positive inside, to a tenth of a cell, at 200 places up
/// to `band` from the sphere of `radius`.
inline void expect_distance_to_unit_sphere(const Field& field, double radius, double band, double cell) {
  Random random(9);
  for (int i = 0; i < 200; ++i) {
    const Vec3d d = random.direction();
    const double r = random.in(radius - band, radius + band);
    EXPECT_NEAR(field.values(std::vector<Vec3d>{{r * d[0], r * d[1], r * d[2]}})[0], (1 - r) / cell, 0.1);
  }
}

}  // namespace pointskin::test
