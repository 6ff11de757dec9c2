// The camera of an interactive view or of a picture, as graphics programs have it.
#pragma once

#include <array>

#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/render.hpp>

namespace pointskin PSK_EXPORT {

/// Four by four, row by row; acts on column vectors (x, y, z, 1).
using Matrix4 = std::array<double, 16>;

/// A view as OpenGL has it: the eye looks along -z of its own frame.
struct Camera {
  Matrix4 view{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};  ///< world to eye: a rotation and a translation
  /// Eye to clip, perspective (last row 0 0 -1 0) or orthographic (last row 0 0 0 1), without skew; its third row,
  /// which holds the clipping planes, is not used.
  Matrix4 projection{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  double width = 1, height = 1;  ///< pixels; (0, 0) is the upper left corner of the picture
};

/// A place on the picture, in pixels: x to the right, y downwards.
using Pixel = std::array<double, 2>;

/// @throws Error usage, saying what is wrong, unless `camera` is as described above, finite, and has pixels
void validate(const Camera& camera);

/// The camera of the picture that render() draws of `mesh`, or of `cloud`. O(v + t), O(n).
/// @throws Error as render()
Camera camera_of(const Mesh& mesh, const RenderOptions& options = {});
Camera camera_of(const Cloud& cloud, const RenderOptions& options = {});

}  // namespace pointskin
