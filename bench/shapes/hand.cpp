// A hand two of whose fingers nearly touch and were not seen where they do: the surface joins them, one handle too many,
// for strokes to remove (Zhou et al. 2010, section 5.1).
#include "hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "smooth.hpp"

namespace pointskin::bench {
namespace {

/// All points less than `radius` away from a segment.
struct Bone {
  Vec3d from, to;
  double radius;

  [[nodiscard]] Sample at(const Vec3d& q) const {
    const Vec3d along = to - from;
    const double t = std::clamp(dot(q - from, along) / dot(along, along), 0.0, 1.0);
    const Vec3d off = q - from - along * t;
    return {length(off) - radius, direction(off)};
  }
};

constexpr std::array<Bone, 5> kPalm = {{{{0, -0.82, 0}, {0, -0.5, 0}, 0.2},
                                        {{0.1, -0.5, 0}, {0.31, -0.02, 0.02}, 0.145},
                                        {{0.04, -0.5, 0}, {0.11, 0.0, 0.03}, 0.15},
                                        {{-0.04, -0.5, 0}, {-0.1, -0.02, 0.03}, 0.145},
                                        {{-0.1, -0.5, 0}, {-0.3, -0.08, 0.01}, 0.135}}};

// Index, middle, ring and little finger, thumb. The index finger bends towards the middle one.
constexpr std::array<Bone, 9> kFingers = {{{{0.34, 0.0, 0.02}, {0.46, 0.36, 0.05}, 0.1},
                                           {{0.46, 0.36, 0.05}, {0.35, 0.6, 0.04}, 0.095},
                                           {{0.35, 0.6, 0.04}, {0.35, 0.78, 0.04}, 0.095},
                                           {{0.11, 0.0, 0.03}, {0.11, 0.84, 0.04}, 0.105},
                                           {{-0.12, 0.0, 0.03}, {-0.2, 0.76, 0.05}, 0.1},
                                           {{-0.33, -0.06, 0.01}, {-0.54, 0.48, 0.04}, 0.085},
                                           {{0.14, -0.55, 0.02}, {0.5, -0.3, 0.12}, 0.13},
                                           {{0.5, -0.3, 0.12}, {0.72, 0.02, 0.16}, 0.11},
                                           {{0.72, 0.02, 0.16}, {0.74, 0.12, 0.16}, 0.105}}};

template <std::size_t N>
Sample join(const std::array<Bone, N>& bones, const Vec3d& q, double k) {
  Sample joined = bones[0].at(q);
  for (std::size_t i = 1; i < N; ++i) joined = smooth_min(joined, bones[i].at(q), k);
  return joined;
}

/// Minima of distances: steeper than 1 nowhere.
class Hand final : public Shape {
 public:
  [[nodiscard]] Topology topology() const override { return {1, 2}; }
  [[nodiscard]] bool is_distance() const override { return false; }
  [[nodiscard]] Sample at(const Vec3d& q) const override {
    return smooth_min(join(kPalm, q, 0.12), join(kFingers, q, 0.02), 0.08);
  }
  [[nodiscard]] bool is_seen(const Vec3d& q) const override { return std::abs(q.x - 0.235) > 0.07 || q.y < 0.5; }
  [[nodiscard]] double variation(const Vec3d& /*centre*/, double radius) const override { return radius; }
};

}  // namespace

std::unique_ptr<Shape> make_hand() { return std::make_unique<Hand>(); }

}  // namespace pointskin::bench
