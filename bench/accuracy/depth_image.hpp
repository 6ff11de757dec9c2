// What one camera of the virtual scanner sees.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "scene.hpp"

namespace pointskin::bench {

/// A pinhole camera with square images.
struct Camera {
  Vec3d position, forward, right, up;  ///< world units; the axes have unit length and are orthogonal
  double half_width = 1;               ///< of the image in the plane at distance 1
  int resolution = 0;                  ///< pixels along each side

  /// Side of a pixel in the plane at distance 1.
  [[nodiscard]] double pixel() const { return 2 * half_width / resolution; }
  /// Unit vector through the middle of a pixel.
  [[nodiscard]] Vec3d direction(int row, int column) const;
  /// How that vector changes along the image's two axes, per unit in the plane at distance 1.
  [[nodiscard]] std::array<Vec3d, 2> direction_derivatives(int row, int column) const;
};

/// Ranges along the rays of a camera, and the exact normals of what they hit.
class DepthImage {
 public:
  explicit DepthImage(const Camera& camera);

  /// Casts the rays of a row and adds noise(column), in world units, to each range. Rows may be taken in parallel.
  void take_row(const Scene& scene, int row, const std::function<double(int)>& noise);

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] bool has(int row, int column) const;
  [[nodiscard]] double range(int row, int column) const { return ranges_[at(row, column)]; }
  [[nodiscard]] Vec3d point(int row, int column) const;
  [[nodiscard]] Vec3d normal(int row, int column) const { return normals_[at(row, column)]; }

  /// Neighbours whose ranges differ by more than slope times their distance plus noise lie on another surface.
  struct Jump {
    double slope;  ///< no unit
    double noise;  ///< world units
  };

  /// The normal of the plane that fits the ranges within `window` pixels best, of any sign; nothing where fewer
  /// than half of them lie on the same surface.
  [[nodiscard]] std::optional<Vec3d> fitted_normal(int row, int column, int window, const Jump& jump) const;

 private:
  [[nodiscard]] std::size_t at(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(camera_.resolution) +
           static_cast<std::size_t>(column);
  }

  Camera camera_;
  std::vector<double> ranges_;  // infinite where a ray hits nothing
  std::vector<Vec3d> normals_;
};

}  // namespace pointskin::bench
