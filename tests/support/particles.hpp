// Particles whose surface is known.
#pragma once

#include <pointskin/cloud.hpp>

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {

/// Particles on a lattice of spacing 2 `radius`, each moved by up to `jitter` radii along every axis, where `inside`
/// holds at the place on the lattice; the lattice is over [-extent, extent]^3.
inline Cloud lattice_particles(double radius, double extent, double jitter, std::uint64_t seed,
                               const std::function<bool(const Vec3d&)>& inside) {
  Random random(seed);
  Cloud cloud;
  const auto side = static_cast<int>(std::floor(extent / (2 * radius)));
  for (int x = -side; x <= side; ++x)
    for (int y = -side; y <= side; ++y)
      for (int z = -side; z <= side; ++z) {
        const Vec3d p{2 * radius * x, 2 * radius * y, 2 * radius * z};
        if (!inside(p)) continue;
        const auto moved = [&](double v) { return static_cast<float>(v + radius * random.in(-jitter, jitter)); };
        cloud.positions.push_back({moved(p[0]), moved(p[1]), moved(p[2])});
      }
  return cloud;
}

inline Cloud ball_of_particles(double radius, double ball_radius, double jitter, std::uint64_t seed) {
  return lattice_particles(radius, ball_radius, jitter, seed,
                           [&](const Vec3d& p) { return length(p) <= ball_radius - radius; });
}

struct NamedParticles {
  std::string name;
  Cloud cloud;
};

/// Frames of particles of radius 1 of every kind: bulk, drops, sheets, threads, spray, doubles.
inline std::vector<NamedParticles> particle_frames(std::uint64_t seed) {
  std::vector<NamedParticles> frames;
  const auto add = [&](const char* name, std::vector<Vec3f> positions) {
    Cloud cloud;
    cloud.positions = std::move(positions);
    frames.push_back({name, std::move(cloud)});
  };
  add("one particle", {{0.3F, -7.1F, 2.2F}});
  add("two at one place", {{1, 1, 1}, {1, 1, 1}});
  add("two that touch", {{0, 0, 0}, {2, 0, 0}});
  add("two in reach", {{0, 0, 0}, {3.7F, 0.2F, 0}});
  add("two apart", {{0, 0, 0}, {4.6F, 0, 0}});
  std::vector<Vec3f> thread;
  for (int i = 0; i < 20; ++i) thread.push_back({2.1F * static_cast<float>(i), 0.3F * static_cast<float>(i % 3), 0});
  add("a thread", thread);
  std::vector<Vec3f> sheet;
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y) sheet.push_back({2.0F * static_cast<float>(x), 2.0F * static_cast<float>(y), 0.7F});
  add("a sheet", sheet);
  frames.push_back({"a ball", ball_of_particles(1, 9, 0.3, seed)});
  frames.push_back({"a block", lattice_particles(1, 8, 0.5, seed, [](const Vec3d&) { return true; })});
  Random random(seed);
  std::vector<Vec3f> spray;
  for (int i = 0; i < 300; ++i)
    spray.push_back({static_cast<float>(random.in(0, 20)), static_cast<float>(random.in(0, 20)),
                     static_cast<float>(random.in(0, 20))});
  add("spray", spray);
  Cloud splash =
      lattice_particles(1, 9, 0.4, seed, [](const Vec3d& p) { return p[2] < -3 + 2 * std::sin(0.5 * p[0]); });
  for (int i = 0; i < 60; ++i)
    splash.positions.push_back({static_cast<float>(random.in(-9, 9)), static_cast<float>(random.in(-9, 9)),
                                static_cast<float>(random.in(-3, 9))});
  frames.push_back({"a splash", std::move(splash)});
  return frames;
}

}  // namespace pointskin::test
