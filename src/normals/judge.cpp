#include "normals/judge.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::normals {
namespace {

constexpr std::size_t kMostTried = 14;

/// What changing the sign of patch a alone adds to the sum, halved twice.
double gain_of_flip(const Couplings& couplings, const std::vector<int>& signs, std::size_t a) {
  double gain = 0;
  for (std::size_t b = 0; b < couplings.count; ++b)
    if (b != a) gain -= signs[a] * signs[b] * couplings.relative(a, b) * std::min(couplings(a, a), couplings(b, b));
  return gain;
}

void climb(const Couplings& couplings, const std::vector<bool>& fixed, std::vector<int>& signs) {
  for (std::size_t steps = 0; steps < 4 * couplings.count; ++steps) {
    std::size_t best = couplings.count;
    double best_gain = 0;
    for (std::size_t a = 0; a < couplings.count; ++a) {
      const double gain = fixed[a] ? 0 : gain_of_flip(couplings, signs, a);
      if (gain > best_gain) {
        best_gain = gain;
        best = a;
      }
    }
    if (best == couplings.count) return;
    signs[best] = -signs[best];
  }
}

}  // namespace

double Couplings::relative(std::size_t a, std::size_t b) const {
  constexpr double kNone = 0.02;
  const double own = std::min((*this)(a, a), (*this)(b, b));
  if (!(own > 0)) return 0;
  const double share = ((*this)(a, b) + (*this)(b, a)) / 2 / own;
  return std::abs(share) < kNone ? 0 : share;
}

void choose_sides(const Sides& sides, const std::vector<bool>& fixed, std::vector<int>& signs) {
  const std::size_t count = sides.areas.size();
  std::vector<std::size_t> free;
  for (std::size_t a = 0; a < count; ++a)
    if (!fixed[a]) free.push_back(a);
  const std::vector<int> start = signs;
  const auto cost_of = [&](const std::vector<int>& now) {
    double cost = 0;
    for (std::size_t b = 0; b < count; ++b) {
      double field = 0;
      for (std::size_t a = 0; a < count; ++a) field += now[a] * sides.means[a * count + b];
      cost += sides.areas[b] * (field - 0.5) * (field - 0.5);
      for (std::size_t a = b + 1; a < count; ++a)
        if (now[a] * now[b] != start[a] * start[b]) cost += sides.ties[a * count + b];
    }
    return cost;
  };
  if (free.size() > kMostTried) free.resize(kMostTried);
  double best = cost_of(signs);
  std::vector<int> now = signs;
  for (std::uint32_t code = 1; code < (1U << free.size()); ++code) {
    std::size_t changed = 0;
    while ((code >> changed & 1U) == 0) ++changed;
    now[free[changed]] = -now[free[changed]];
    const double cost = cost_of(now);
    if (cost < best * (1 - 1e-9)) {
      best = cost;
      signs = now;
    }
  }
}

void choose_signs(const Couplings& couplings, const std::vector<bool>& fixed, std::vector<int>& signs) {
  std::vector<std::size_t> free;
  for (std::size_t a = 0; a < couplings.count; ++a)
    if (!fixed[a]) free.push_back(a);
  if (free.size() > kMostTried) return climb(couplings, fixed, signs);
  // Gray code: one sign changes from one combination to the next.
  std::vector<int> now = signs;
  double sum = 0;
  double best = 0;
  for (std::uint32_t code = 1; code < (1U << free.size()); ++code) {
    std::size_t changed = 0;
    while ((code >> changed & 1U) == 0) ++changed;
    sum += gain_of_flip(couplings, now, free[changed]);
    now[free[changed]] = -now[free[changed]];
    if (sum > best * (1 + 1e-9) + 1e-12) {
      best = sum;
      signs = now;
    }
  }
}

}  // namespace pointskin::normals
