// What can be drawn: the triangles of a mesh, the discs of a cloud.
#pragma once

#include <cstdint>

#include "render/colour.hpp"
#include "render/raster.hpp"

namespace pointskin::render_detail {

/// What a sample sees.
struct Seen {
  Vec3d normal{0, 0, 0};  ///< of the side that is seen, in the viewer's frame, unit length; zero: not known
  Colour albedo{};
  bool front = true;  ///< it is seen from outside
  double relief = 1;  ///< share of `normal` in the light; the rest is that of the picture's depth
  double line = 0;    ///< share of an edge's colour, in [0, 1]
};

/// Parts by number, in [0, size()).
class Drawing {
 public:
  virtual ~Drawing() = default;
  Drawing() = default;
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  [[nodiscard]] virtual std::int64_t size() const = 0;
  /// Steps from the top that a part lies between; empty if it is not drawn.
  [[nodiscard]] virtual Span rows(std::int64_t id) const = 0;
  virtual void draw(std::int64_t id, Band& band) const = 0;
  /// What a sample at a place (steps) inside of a part sees.
  [[nodiscard]] virtual Seen seen(std::int32_t id, std::int64_t x, std::int64_t y) const = 0;
  /// True if seen() knows the normal alone; but of single points it may not: those with a normal of no length, or square to the
  /// way to the viewer, are seen as balls.
  [[nodiscard]] virtual bool knows_normals() const = 0;
};

}  // namespace pointskin::render_detail
