#include "spoil.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/vec3.hpp"
#include "random.hpp"

namespace pointskin::bench {
namespace {

/// Streams of random numbers: one for each fault, so that adding one does not change the others.
enum Stream : std::uint64_t { density, holes, keeping, noise, flipping, outlying };

/// What is done, step by step, in double.
class Spoiler {
 public:
  Spoiler(const Cloud& cloud, const SpoilOptions& options) : options_(options) {
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      places_.push_back(cloud.origin + to_double(cloud.positions[i]));
      normals_.push_back(to_double(cloud.normals[i]));
    }
    lower_ = upper_ = places_[0];
    for (const Vec3d& p : places_)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower_[axis] = std::min(lower_[axis], p[axis]);
        upper_[axis] = std::max(upper_[axis], p[axis]);
      }
    const Vec3d sides = upper_ - lower_;
    diagonal_ = length(sides);
    for (std::size_t axis = 1; axis < 3; ++axis)
      if (sides[axis] > sides[longest_]) longest_ = axis;
  }

  void take_away() {
    if (options_.outside) {
      const Vec3d middle = 0.5 * (lower_ + upper_);
      keep_if([&](std::size_t i) { return dot(places_[i] - middle, normals_[i]) > 0; });
    }
    if (options_.density_ratio > 1) {
      const double side = upper_[longest_] - lower_[longest_];
      keep_if([&](std::size_t i) {
        const double along = side > 0 ? (places_[i][longest_] - lower_[longest_]) / side : 0;
        return random(density, i).uniform() < std::pow(options_.density_ratio, -along);
      });
    }
    cut_holes();
    if (options_.lines > 0) draw_to_lines();
    if (options_.keep > 0 && options_.keep < count()) keep_some(options_.keep);
    if (places_.empty()) throw Error(ErrorCode::empty_result, "no point is left");
  }

  void disturb() {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      Random numbers = random(noise, i);
      const auto [a, b] = numbers.gaussian_pair();
      const auto [c, d] = numbers.gaussian_pair();
      const auto [e, f] = numbers.gaussian_pair();
      places_[i] = places_[i] + options_.sigma * diagonal_ * Vec3d{a, b, c};
      if (options_.normal_noise > 0) normals_[i] = normalized(normals_[i] + options_.normal_noise * Vec3d{d, e, f});
      if (random(flipping, i).uniform() < options_.flipped) normals_[i] = -normals_[i];
      if (options_.quantum > 0) places_[i] = rounded(places_[i], options_.quantum * diagonal_);
    }
  }

  /// Among the points, so that no order tells of them.
  void add_outliers() {
    const auto total = static_cast<std::int64_t>(std::llround(static_cast<double>(count()) / (1 - options_.outliers)));
    const std::int64_t added = options_.outliers > 0 ? total - count() : 0;
    for (std::int64_t i = 0; i < added; ++i) {
      Random numbers = random(outlying, static_cast<std::uint64_t>(i));
      const Vec3d place = options_.clusters > 0 ? in_cluster(numbers, i % options_.clusters) : in_box(numbers);
      const auto [a, b] = numbers.gaussian_pair();
      const auto [c, d] = numbers.gaussian_pair();
      const auto at = static_cast<std::ptrdiff_t>(numbers.uniform() * static_cast<double>(count() + 1));
      places_.push_back(place);
      normals_.push_back(normalized(Vec3d{a, b, c}));
      std::swap(places_[static_cast<std::size_t>(at)], places_.back());
      std::swap(normals_[static_cast<std::size_t>(at)], normals_.back());
    }
  }

  [[nodiscard]] Cloud take(const Vec3d& origin) const {
    Cloud cloud;
    cloud.origin = origin;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      cloud.positions.push_back(to_float(places_[i] - origin));
      cloud.normals.push_back(to_float(normals_[i]));
    }
    return cloud;
  }

 private:
  [[nodiscard]] std::int64_t count() const { return static_cast<std::int64_t>(places_.size()); }

  [[nodiscard]] Random random(Stream stream, std::uint64_t index) const {
    return {options_.seed, (std::uint64_t{stream} << 56U) + index};
  }

  template <class Keep>
  void keep_if(const Keep& keep) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (!keep(i)) continue;
      places_[kept] = places_[i];
      normals_[kept++] = normals_[i];
    }
    places_.resize(kept);
    normals_.resize(kept);
  }

  /// The points nearest to a few of them, so many around each.
  void cut_holes() {
    const auto all = static_cast<double>(count());
    const auto each = static_cast<std::size_t>(options_.holes * all / options_.hole_count);
    for (int hole = 0; hole < options_.hole_count && each > 0 && each < places_.size(); ++hole) {
      Random numbers = random(holes, static_cast<std::uint64_t>(hole));
      const Vec3d middle = places_[static_cast<std::size_t>(numbers.uniform() * static_cast<double>(count()))];
      std::vector<double> distances;
      for (const Vec3d& p : places_) distances.push_back(length(p - middle));
      std::vector<double> sorted = distances;
      std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(each), sorted.end());
      keep_if([&](std::size_t i) { return distances[i] >= sorted[each]; });
    }
  }

  /// Moves points in a thin layer around each of the planes along their own surface into it; the others are dropped.
  void draw_to_lines() {
    const double pitch = options_.lines * diagonal_;
    constexpr double kLayer = 0.1;  // of the pitch, to either side
    const auto plane = [&](std::size_t i) { return pitch * std::round(places_[i][longest_] / pitch); };
    keep_if([&](std::size_t i) {
      const double along = normals_[i][longest_];
      return std::abs(places_[i][longest_] - plane(i)) < kLayer * pitch && 1 - along * along > 0.04;
    });
    for (std::size_t i = 0; i < places_.size(); ++i) {
      Vec3d direction = -normals_[i][longest_] * normals_[i];  // the axis, without what stands on the surface
      direction[longest_] += 1;
      places_[i] = places_[i] + ((plane(i) - places_[i][longest_]) / direction[longest_]) * direction;
    }
  }

  /// The points with the smallest random numbers.
  void keep_some(std::int64_t wanted) {
    std::vector<std::pair<std::uint64_t, std::size_t>> drawn;
    for (std::size_t i = 0; i < places_.size(); ++i) drawn.emplace_back(random(keeping, i).bits(), i);
    std::nth_element(drawn.begin(), drawn.begin() + (wanted - 1), drawn.end());
    const auto last = drawn[static_cast<std::size_t>(wanted - 1)];
    keep_if([&](std::size_t i) { return std::pair(random(keeping, i).bits(), i) <= last; });
  }

  static Vec3d rounded(const Vec3d& p, double step) {
    return {step * std::round(p.x / step), step * std::round(p.y / step), step * std::round(p.z / step)};
  }

  [[nodiscard]] Vec3d in_box(Random& numbers) const {
    constexpr double kLarger = 1.2;
    Vec3d p;
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] =
          0.5 * (lower_[axis] + upper_[axis]) + kLarger * (numbers.uniform() - 0.5) * (upper_[axis] - lower_[axis]);
    return p;
  }

  [[nodiscard]] Vec3d in_cluster(Random& numbers, std::int64_t cluster) const {
    constexpr double kRadius = 0.02;
    Random place = random(outlying, (std::uint64_t{1} << 48U) + static_cast<std::uint64_t>(cluster));
    const Vec3d middle = in_box(place);
    const auto [a, b] = numbers.gaussian_pair();
    const auto [c, d] = numbers.gaussian_pair();
    return middle + kRadius * diagonal_ * std::cbrt(numbers.uniform()) * normalized(Vec3d{a, b, c});
  }

  const SpoilOptions& options_;
  std::vector<Vec3d> places_, normals_;
  Vec3d lower_, upper_;
  double diagonal_ = 0;
  std::size_t longest_ = 0;
};

void check(const Cloud& cloud, const SpoilOptions& o) {
  const auto is_share = [](double v) { return v >= 0 && v < 1; };
  if (cloud.size() == 0) throw Error(ErrorCode::empty_result, "no point is left");
  if (cloud.normals.empty()) throw Error(ErrorCode::usage, "the points have no normals");
  if (!(o.density_ratio >= 1) || !is_share(o.holes) || o.hole_count < 1 || !(o.lines >= 0) || o.keep < 0 ||
      !(o.sigma >= 0) || !(o.normal_noise >= 0) || !(o.flipped >= 0 && o.flipped <= 1) || !(o.quantum >= 0) ||
      !is_share(o.outliers) || o.clusters < 0)
    throw Error(ErrorCode::usage, "an option is out of range");
}

}  // namespace

Cloud spoil(const Cloud& cloud, const SpoilOptions& options) {
  check(cloud, options);
  Spoiler spoiler(cloud, options);
  spoiler.take_away();
  spoiler.disturb();
  spoiler.add_outliers();
  return spoiler.take(cloud.origin);
}

}  // namespace pointskin::bench
