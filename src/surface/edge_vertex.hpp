// Where the surface crosses an edge of the octree, and its normal there.
#pragma once

#include <cmath>
#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/vec3.hpp"
#include "field/field_view.hpp"
#include "surface/leaf_cell.hpp"

namespace pointskin::surface {

/// Crossings keep this distance (in edge lengths) from the edge's ends, so that vertices around a corner stay apart (as
/// far as floats of the unit cube can: from depth 14 on they may coincide).
inline constexpr float kCrossingMargin = 1e-3F;

/// An edge that the surface crosses: its end corners and, where they exist, one more corner on either side.
struct CrossedEdge {
  int level;
  std::int32_t before, start, end, after;
};

PSK_HD inline CrossedEdge crossed_edge(const octree::OctreeView& tree, const EdgeOwner& owner) {
  const octree::LevelView& l = tree.levels[owner.level];
  const int x = owner.axis == 0 ? 1 : 0;
  const int y = owner.axis == 1 ? 1 : 0;
  const int z = owner.axis == 2 ? 1 : 0;
  // Ghost bricks hold a node beyond the cube's upper faces, without a value.
  const octree::Coordinates c = octree::decode(l.node_key(owner.node));
  const std::int32_t along = owner.axis == 0 ? c.x : owner.axis == 1 ? c.y : c.z;
  const bool at_face = along + 1 == 1 << owner.level;
  return {owner.level, l.neighbour(owner.node, -x, -y, -z), owner.node, l.neighbour(owner.node, x, y, z),
          at_face ? -1 : l.neighbour(owner.node, 2 * x, 2 * y, 2 * z)};
}

/// Root in [0, 1] of u0 + s0 t + (d - s0) t^2, whose values at 0 and 1 have different signs.
PSK_HD inline float quadratic_root(float u0, float s0, float d) {
  const float a = d - s0;
  const float discriminant = s0 * s0 - 4 * a * u0;
  const float root = std::sqrt(discriminant > 0 ? discriminant : 0);
  // The well-conditioned form; the other root is outside because the ends' signs differ.
  const float q = -0.5F * (s0 + (d >= 0 ? root : -root));
  const float linear = -u0 / d;
  // For increasing values the wanted root has positive slope: t = u0 / q.
  const float t = q != 0 ? u0 / q : linear;
  return t >= 0 && t <= 1 ? t : linear;
}

/// Parameter in (0, 1) of the crossing. With neighbours on both sides, slopes from central differences, rescaled so
/// that their mean is the difference of the ends, give a quadratic; else linear interpolation.
/// @param curvature  share of the quadratic's second derivative that is taken, 0: linear
PSK_HD inline float crossing_parameter(const field::FieldView& f, const CrossedEdge& e, float curvature) {
  const float u0 = f.value(e.level, e.start) - f.isovalue;
  const float u1 = f.value(e.level, e.end) - f.isovalue;
  // Closed at the cube's faces: a corner there counts as outside whatever its value, and the cap lies next to it.
  if ((u0 < 0) == (u1 < 0)) {
    const octree::Coordinates c = octree::decode(f.tree.levels[e.level].node_key(e.start));
    return f.inside(e.level, e.start, c) ? 1 - kCrossingMargin : kCrossingMargin;
  }
  const float d = u1 - u0;
  float t = -u0 / d;
  if (curvature > 0 && e.before >= 0 && e.after >= 0) {
    const float s0 = 0.5F * (u1 - (f.value(e.level, e.before) - f.isovalue));
    const float s1 = 0.5F * ((f.value(e.level, e.after) - f.isovalue) - u0);
    const float mean = 0.5F * (s0 + s1);
    if (mean != 0) t = quadratic_root(u0, d + curvature * (s0 * (d / mean) - d), d);
  }
  return t < kCrossingMargin ? kCrossingMargin : t > 1 - kCrossingMargin ? 1 - kCrossingMargin : t;
}

/// -v / |v|, or zero if v is: values fall towards the outside.
PSK_HD inline Vec3f outward(const Vec3f& v) {
  constexpr float kShortest = 1e-15F;  // squares of shorter ones have lost digits, of longer ones are not finite
  constexpr float kLongest = 1e15F;
  const float size = length(v);
  if (size > kShortest && size < kLongest) return -v / size;
  const float x = v.x < 0 ? -v.x : v.x;
  const float y = v.y < 0 ? -v.y : v.y;
  const float z = v.z < 0 ? -v.z : v.z;
  const float largest = x > y ? (x > z ? x : z) : (y > z ? y : z);
  if (!(largest > 0)) return {};
  const Vec3f scaled = v / largest;
  return -scaled / length(scaled);
}

/// The normal where gradients cancel: out along the edge from its inner end, the only slope that is known there.
PSK_HD inline Vec3f outward_along(const field::FieldView& f, const EdgeOwner& owner, const octree::Coordinates& start) {
  const float way = f.inside(owner.level, owner.node, start) ? 1.0F : -1.0F;
  return {owner.axis == 0 ? way : 0.0F, owner.axis == 1 ? way : 0.0F, owner.axis == 2 ? way : 0.0F};
}

}  // namespace pointskin::surface
