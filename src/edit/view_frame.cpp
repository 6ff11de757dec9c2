#include "edit/view_frame.hpp"

#include <cmath>
#include <cstddef>

#include "edit/require.hpp"

namespace pointskin {
namespace {

double at(const Matrix4& m, std::size_t row, std::size_t column) { return m[4 * row + column]; }

bool is_finite(const Matrix4& m) {
  for (const double value : m)
    if (!std::isfinite(value)) return false;
  return true;
}

/// Matrices come from programs that compute in float.
bool is_near(double value, double wanted) { return std::abs(value - wanted) <= 1e-3; }

bool has_last_row(const Matrix4& m, double z, double w) {
  return is_near(at(m, 3, 0), 0) && is_near(at(m, 3, 1), 0) && is_near(at(m, 3, 2), z) && is_near(at(m, 3, 3), w);
}

bool is_perspective(const Camera& camera) { return has_last_row(camera.projection, -1, 0); }

bool is_rotation(const Matrix4& m) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double product = at(m, i, 0) * at(m, j, 0) + at(m, i, 1) * at(m, j, 1) + at(m, i, 2) * at(m, j, 2);
      if (!is_near(product, i == j ? 1 : 0)) return false;
    }
  const double determinant = at(m, 0, 0) * (at(m, 1, 1) * at(m, 2, 2) - at(m, 1, 2) * at(m, 2, 1)) -
                             at(m, 0, 1) * (at(m, 1, 0) * at(m, 2, 2) - at(m, 1, 2) * at(m, 2, 0)) +
                             at(m, 0, 2) * (at(m, 1, 0) * at(m, 2, 1) - at(m, 1, 1) * at(m, 2, 0));
  return determinant > 0;
}

}  // namespace

void validate(const Camera& camera) {
  const Matrix4& projection = camera.projection;
  edit::require(is_finite(camera.view) && is_finite(projection), "the camera's matrices must be finite");
  edit::require(camera.width > 0 && camera.height > 0 && std::isfinite(camera.width) && std::isfinite(camera.height),
                "the camera's width and height must be above 0 pixels");
  edit::require(is_rotation(camera.view) && has_last_row(camera.view, 0, 1),
                "the camera's view matrix must be a rotation and a translation, row by row");
  const bool perspective = is_perspective(camera);
  edit::require(
      perspective || has_last_row(projection, 0, 1),
      "the last row of the camera's projection matrix must be 0 0 -1 0 (perspective) or 0 0 0 1 (orthographic)");
  const std::size_t unused = perspective ? 3 : 2;  // of the rows of x and y
  edit::require(at(projection, 0, 1) == 0 && at(projection, 1, 0) == 0 && at(projection, 0, unused) == 0 &&
                    at(projection, 1, unused) == 0,
                "the camera's projection matrix must have no skew");
  edit::require(at(projection, 0, 0) > 0 && at(projection, 1, 1) > 0,
                "the camera's projection matrix must have scales above 0 for x and y");
}

namespace edit {

ViewFrame frame_of(const Camera& camera, const Vec3d& origin) {
  ViewFrame frame;
  frame.perspective = is_perspective(camera);
  for (std::size_t a = 0; a < 3; ++a) {
    frame.right[a] = at(camera.view, 0, a);
    frame.up[a] = at(camera.view, 1, a);
    frame.back[a] = at(camera.view, 2, a);
  }
  for (std::size_t a = 0; a < 3; ++a) {  // the eye is where the view matrix gives 0
    double eye = 0;
    for (std::size_t row = 0; row < 3; ++row) eye -= at(camera.view, row, a) * at(camera.view, row, 3);
    frame.eye[a] = eye - origin[a];
  }
  return frame;
}

PlanePoint to_plane(const Camera& camera, const Pixel& pixel) {
  const Matrix4& p = camera.projection;
  const double x = 2 * pixel[0] / camera.width - 1;
  const double y = 1 - 2 * pixel[1] / camera.height;
  if (is_perspective(camera)) return {(x + at(p, 0, 2)) / at(p, 0, 0), (y + at(p, 1, 2)) / at(p, 1, 1)};
  return {(x - at(p, 0, 3)) / at(p, 0, 0), (y - at(p, 1, 3)) / at(p, 1, 1)};
}

}  // namespace edit
}  // namespace pointskin
