// Many different reconstructions, and the hash that tells their results apart.
#pragma once

#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "support/attributes.hpp"
#include "support/option_sets.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {

struct Job {
  std::string name;
  Cloud cloud;
  Options options;
};

/// One of six shapes of `points` points within [-2, 2]^3, with an attribute.
inline Cloud endurance_cloud(int number, std::int64_t points) {
  const auto seed = static_cast<std::uint64_t>(number);
  const auto shape = [&] {
    switch (number % 6) {
      case 0:
        return sphere_cloud(points, seed);
      case 1:
        return torus_cloud(points, seed);
      case 2:
        return box_cloud(points, seed);
      case 3:
        return jittered(linked_tori_cloud(points, seed), seed, 0.01);
      case 4:
        return flipped(sphere_cloud(points, seed, 1.4));
      default:
        return plane_cloud(points, seed);
    }
  };
  Cloud cloud = shape();
  cloud.attributes.push_back(attribute_of<float>("height", cloud.positions, [](const Vec3f& p) { return p.z; }));
  return cloud;
}

/// `count` jobs of 300 to 3000 points and depths 3 to 6, with every set of options.
inline std::vector<Job> endurance_jobs(int count) {
  std::vector<Job> jobs;
  for (int i = 0; i < count; ++i) {
    auto sets = option_sets(3 + i % 4, true);
    auto& [name, options] = sets[static_cast<std::size_t>(i) % sets.size()];
    jobs.push_back({name + ", number " + std::to_string(i), endurance_cloud(i, 300 + 900 * (i % 4)), options});
  }
  return jobs;
}

/// FNV-1a over bytes.
/// Source: Fowler, Noll & Vo, "The FNV Non-Cryptographic Hash Algorithm", draft-eastlake-fnv.
class Hash {
 public:
  template <class T>
  Hash& add(const std::vector<T>& values) {
    for (const std::byte b : std::as_bytes(std::span(values)))
      value_ = (value_ ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3;
    return *this;
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

/// Of vertices, normals, triangles and attributes.
inline std::uint64_t hash_of(const Mesh& mesh) {
  Hash hash;
  hash.add(mesh.vertices).add(mesh.normals).add(mesh.triangles);
  for (const Attribute& attribute : mesh.attributes) hash.add(floats_of(attribute));
  return hash.value();
}

/// Hash of what the job gives alone, in a Reconstructor of its own.
inline std::uint64_t hash_alone(const Job& job, const Device& device) {
  return hash_of(Reconstructor(device).reconstruct(job.cloud, job.options));
}

/// The number that the environment variable `name` has, else `otherwise`.
inline int number_from_environment(const char* name, int otherwise) {
  const char* value = std::getenv(name);
  return value != nullptr ? std::atoi(value) : otherwise;
}

/// Runs of an endurance test: few in every ctest, 1000 in `./check endurance`.
inline int endurance_runs() { return number_from_environment("POINTSKIN_ENDURANCE_RUNS", 100); }

}  // namespace pointskin::test
