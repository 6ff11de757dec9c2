#include "trim_thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace pointskin::studio {
namespace {

/// Vertices by the cells of a grid whose cells are a few vertices wide.
class VertexGrid {
 public:
  explicit VertexGrid(const Mesh& mesh) : mesh_(mesh), lower_(bounds_of(mesh.vertices).lower), side_(side_of(mesh)) {
    cells_.reserve(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      cells_.emplace_back(key(place(mesh.vertices[i], 0), place(mesh.vertices[i], 1), place(mesh.vertices[i], 2)), i);
    std::sort(cells_.begin(), cells_.end());
  }

  /// The vertex nearest to p of those in the cells around; -1 if there is none.
  [[nodiscard]] std::int64_t nearest(const Vec3f& p) const {
    std::int64_t best = -1;
    float least = std::numeric_limits<float>::max();
    const std::int64_t x = place(p, 0);
    for (std::int64_t z = place(p, 2) - 1, row = 0; row < 9; ++row) {
      const std::int64_t y = place(p, 1) - 1 + row % 3;
      const auto end = key(x + 1, y, z + row / 3);
      auto cell = std::lower_bound(cells_.begin(), cells_.end(), std::pair{key(x - 1, y, z + row / 3), std::size_t{0}});
      for (; cell != cells_.end() && cell->first <= end; ++cell) {
        const float distance = squared_length(mesh_.vertices[cell->second] - p);
        if (distance >= least) continue;
        least = distance;
        best = static_cast<std::int64_t>(cell->second);
      }
    }
    return best;
  }

 private:
  /// Twice as far as vertices lie apart on the mean.
  static float side_of(const Mesh& mesh) {
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
      const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
      area += std::sqrt(double{squared_length(cross(corner(1) - corner(0), corner(2) - corner(0)))}) / 2;
    }
    const double side = 2 * std::sqrt(area / static_cast<double>(std::max(mesh.vertices.size(), std::size_t{1})));
    return side > 0 ? static_cast<float>(side) : 1;
  }

  /// Cell along an axis, from 1 on for vertices; what is far outside lies in the outermost cells.
  [[nodiscard]] std::int64_t place(const Vec3f& p, std::size_t axis) const {
    constexpr float kLast = 1 << 20;
    return 1 + static_cast<std::int64_t>(std::clamp((p[axis] - lower_[axis]) / side_, -1.0F, kLast));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    constexpr int kBits = 21;
    return static_cast<std::uint64_t>((z + 1) << 2 * kBits | (y + 1) << kBits | (x + 1));
  }

  const Mesh& mesh_;
  Vec3f lower_;
  float side_;
  std::vector<std::pair<std::uint64_t, std::size_t>> cells_;
};

}  // namespace

std::vector<float> densities_at_samples(const Mesh& mesh, const std::vector<float>& density, const Cloud& cloud) {
  if (mesh.vertices.empty()) return {};
  constexpr std::size_t kSamples = 50'000;
  const VertexGrid grid(mesh);
  const std::size_t step = (cloud.positions.size() + kSamples - 1) / kSamples;
  const Vec3d shift = cloud.origin - mesh.origin;
  std::vector<float> found;
  for (std::size_t i = 0; i < cloud.positions.size(); i += step) {
    const Vec3f& p = cloud.positions[i];
    const std::int64_t vertex =
        grid.nearest({static_cast<float>(shift.x + double{p.x}), static_cast<float>(shift.y + double{p.y}),
                      static_cast<float>(shift.z + double{p.z})});
    if (vertex >= 0) found.push_back(density[static_cast<std::size_t>(vertex)]);
  }
  std::sort(found.begin(), found.end());
  return found;
}

double trim_threshold(const std::vector<float>& at_samples, double share) {
  constexpr double kSparser = 1.75 * 1.75;  // as reconstruct/trim_to_samples
  const auto at = static_cast<std::size_t>(share * static_cast<double>(at_samples.size()));
  return double{at_samples[std::min(at, at_samples.size() - 1)]} / kSparser;
}

}  // namespace pointskin::studio
