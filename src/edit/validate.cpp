#include <pointskin/error.hpp>

#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include "edit/change.hpp"
#include "edit/require.hpp"

namespace pointskin::edit {
namespace {

bool is_finite(const std::vector<Pixel>& pixels) {
  for (const Pixel& p : pixels)
    if (!std::isfinite(p[0]) || !std::isfinite(p[1])) return false;
  return true;
}

void check(const Area& area) {
  require(!area.empty(), "the operation has no area; give it polygons");
  for (const std::vector<Pixel>& polygon : area) {
    require(polygon.size() >= 3, "a polygon needs at least 3 corners");
    require(is_finite(polygon), "the corners of polygons must be finite");
  }
}

bool has_length(const std::vector<Pixel>& stroke) {
  for (const Pixel& p : stroke)
    if (p != stroke.front()) return true;
  return false;
}

void check(const Guide& guide) {
  pointskin::validate(guide.camera);
  require(guide.stroke.empty() != guide.area.empty(), "a guide needs either a stroke or an area");
  require(is_finite(guide.stroke), "the points of a stroke must be finite");
  if (guide.stroke.empty()) check(guide.area);
  require(guide.interval >= 0 && std::isfinite(guide.interval), "the interval of a guide must be at least 0");
  require(guide.normals == GuideNormals::cloud || has_length(guide.stroke),
          "normals to the right of a stroke need a stroke with a length");
}

void check(const Remove& remove) {
  pointskin::validate(remove.camera);
  check(remove.area);
}

void check(const Flip& flip) {
  pointskin::validate(flip.camera);
  check(flip.area);
}

void check(const Insert& insert) {
  require(insert.part != nullptr, "an inserted part needs a cloud");
  for (std::size_t a = 0; a < 3; ++a)
    require(insert.lower[a] <= insert.upper[a], "the box of a part must have its lower corner below its upper one");
  if (!insert.area.empty()) {
    pointskin::validate(insert.camera);
    check(insert.area);
  }
  const Similarity& s = insert.placement;
  require(s.scale > 0 && std::isfinite(s.scale), "the scale of a part's placement must be above 0");
  for (const double t : {s.translation.x, s.translation.y, s.translation.z})
    require(std::isfinite(t), "the translation of a part must be finite");
  Camera as_camera;  // whose view must be a rotation, too
  for (std::size_t i = 0; i < 9; ++i) as_camera.view[4 * (i / 3) + i % 3] = s.rotation[i];
  try {
    pointskin::validate(as_camera);
  } catch (const Error&) {
    throw Error(ErrorCode::usage, "the rotation of a part's placement must be a rotation matrix, row by row");
  }
}

}  // namespace

void validate(const Operation& operation) {
  std::visit([](const auto& kind) { check(kind); }, operation);
}

}  // namespace pointskin::edit
