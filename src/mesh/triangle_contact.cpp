// Sources: Devillers & Guigue, "Faster triangle-triangle intersection tests", INRIA RR-4488, 2002 (intervals on the
// line of two planes, compared by orientations alone); for segments and points the definitions.
//
// What is asked beside the shared corners comes down to plain intersections of closed sets:
// - Nothing shared: two triangles meet if and only if an edge of one meets the other. (What they have in common is
//   convex, and an end of it lies on a border.)
// - One place v shared: all of S lies on segments from v to what is opposite of v, the edge between the other corners.
//   If a point other than v lies in both S and T, the ray from v through it leaves S there, and T there; the nearer of
//   these two places lies in both. So S and T meet beside v if and only if what is opposite of v in one meets the
//   other.
// - An edge shared: the line through it cuts two planes apart, and both triangles meet it in that edge. There is more
//   only where both lie in one plane, on the same side of the edge, or have no area and go on along the line.
#include "mesh/triangle_contact.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>

#include "core/vec3.hpp"
#include "mesh/exact_sign.hpp"

namespace pointskin::mesh_detail {
namespace {

using Signs = std::array<int, 3>;

bool precedes(const Vec3f& a, const Vec3f& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }
const Vec3f& first_of(const Vec3f& a, const Vec3f& b) { return precedes(b, a) ? b : a; }
const Vec3f& last_of(const Vec3f& a, const Vec3f& b) { return precedes(b, a) ? a : b; }

/// An axis along which a, b and c can be projected and are no line afterwards; none if they are one already.
std::optional<int> axis_across(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  for (int axis = 0; axis < 3; ++axis)
    if (turn(a, b, c, axis) != 0) return axis;
  return std::nullopt;
}

/// Points of one line are ordered along it as their coordinates are, x before y before z.
bool is_on_segment(const Vec3f& p, const Vec3f& a, const Vec3f& b) {
  if (precedes(p, first_of(a, b)) || precedes(last_of(a, b), p)) return false;
  return !axis_across(a, b, p);
}

/// An axis along which four points of one plane can be projected; none if all are on a line.
std::optional<int> axis_across(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  for (const auto& axis : {axis_across(a, b, c), axis_across(a, b, d), axis_across(a, c, d)})
    if (axis) return axis;
  return std::nullopt;
}

/// Closed segments, which may be points.
bool segments_meet(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  if (is_on_segment(a, c, d) || is_on_segment(b, c, d) || is_on_segment(c, a, b) || is_on_segment(d, a, b)) return true;
  if (side_of_plane(a, b, c, d) != 0) return false;
  const auto axis = axis_across(a, b, c, d);
  if (!axis) return false;  // on a line, with no end of one in the other
  return turn(a, b, c, *axis) * turn(a, b, d, *axis) < 0 && turn(c, d, a, *axis) * turn(c, d, b, *axis) < 0;
}

/// A triangle as a set of points.
class Shape {
 public:
  explicit Shape(const std::array<Vec3f, 3>& corners)
      : p_(corners),
        across_(axis_across(corners[0], corners[1], corners[2])),
        first_(first_of(first_of(p_[0], p_[1]), p_[2])),
        last_(last_of(last_of(p_[0], p_[1]), p_[2])) {}

  [[nodiscard]] const Vec3f& corner(std::size_t k) const { return p_[k % 3]; }
  [[nodiscard]] bool has_area() const { return across_.has_value(); }
  /// An axis along which a triangle with area can be projected.
  [[nodiscard]] int across() const { return *across_; }
  /// The ends of a triangle without area.
  [[nodiscard]] const Vec3f& first() const { return first_; }
  [[nodiscard]] const Vec3f& last() const { return last_; }

  [[nodiscard]] int side_of(const Vec3f& p) const { return side_of_plane(p_[0], p_[1], p_[2], p); }
  [[nodiscard]] Signs sides_of(const Shape& other) const {
    return {side_of(other.p_[0]), side_of(other.p_[1]), side_of(other.p_[2])};
  }

  [[nodiscard]] bool contains(const Vec3f& q) const {
    if (!has_area()) return is_on_segment(q, first_, last_);
    if (side_of(q) != 0) return false;
    const auto [least, most] = std::minmax(
        {turn(p_[0], p_[1], q, *across_), turn(p_[1], p_[2], q, *across_), turn(p_[2], p_[0], q, *across_)});
    return least * most >= 0;
  }

  /// Whether the closed segment from a to b, which may be a point, meets the triangle.
  [[nodiscard]] bool meets(const Vec3f& a, const Vec3f& b) const {
    if (a == b) return contains(a);
    if (!has_area()) return segments_meet(a, b, first_, last_);
    const int side_a = side_of(a), side_b = side_of(b);
    if (side_a * side_b > 0) return false;
    if (side_a == 0 && side_b == 0) return meets_in_plane(a, b);
    if (side_a == 0 || side_b == 0) return contains(side_a == 0 ? a : b);
    const auto [least, most] = std::minmax(
        {side_of_plane(a, b, p_[0], p_[1]), side_of_plane(a, b, p_[1], p_[2]), side_of_plane(a, b, p_[2], p_[0])});
    return least * most >= 0;
  }

 private:
  [[nodiscard]] bool meets_in_plane(const Vec3f& a, const Vec3f& b) const {
    return contains(a) || contains(b) || segments_meet(a, b, p_[0], p_[1]) || segments_meet(a, b, p_[1], p_[2]) ||
           segments_meet(a, b, p_[2], p_[0]);
  }

  const std::array<Vec3f, 3>& p_;
  std::optional<int> across_;
  Vec3f first_, last_;
};

bool any_edge_meets(const Shape& s, const Shape& t) {
  for (std::size_t k = 0; k < 3; ++k)
    if (t.meets(s.corner(k), s.corner(k + 1))) return true;
  return false;
}

/// Whether what is opposite of the place v in s meets t.
bool opposite_meets(const Shape& s, const Vec3f& v, const Shape& t) {
  if (s.has_area()) {
    const std::size_t k = s.corner(0) == v ? 0 : s.corner(1) == v ? 1 : 2;
    return t.meets(s.corner(k + 1), s.corner(k + 2));
  }
  return (s.first() != v && t.contains(s.first())) || (s.last() != v && t.contains(s.last()));
}

/// Whether s and t, which share the edge from u to v, have more in common; a and b are their other corners.
bool meet_beside_edge(const Shape& s, const Shape& t, const std::array<Vec3f, 2>& edge, const Vec3f& a,
                      const Vec3f& b) {
  const auto& [u, v] = edge;
  if (s.has_area() != t.has_area()) return false;
  if (s.has_area()) return side_of_plane(u, v, a, b) == 0 && turn(u, v, a, s.across()) * turn(u, v, b, s.across()) > 0;
  return precedes(last_of(s.first(), t.first()), first_of(u, v)) ||
         precedes(last_of(u, v), first_of(s.last(), t.last()));
}

/// The places of the corners that two triangles share, without repetition, and the corner of each that is not shared
/// where two are.
struct Shared {
  std::array<Vec3f, 2> places{};
  std::size_t count = 0;  ///< of different ids, 0 to 3
};

bool has_corner(const MeshTriangle& t, std::int32_t id) { return t.ids[0] == id || t.ids[1] == id || t.ids[2] == id; }

Shared shared_corners(const MeshTriangle& s, const MeshTriangle& t) {
  Shared shared;
  for (std::size_t k = 0; k < 3; ++k) {
    const bool seen = (k > 0 && s.ids[k] == s.ids[0]) || (k > 1 && s.ids[k] == s.ids[1]);
    if (seen || !has_corner(t, s.ids[k])) continue;
    if (shared.count < 2) shared.places[shared.count] = s.corners[k];
    ++shared.count;
  }
  return shared;
}

/// The corner of s that t does not have; any if there is none.
const Vec3f& other_corner(const MeshTriangle& s, const MeshTriangle& t) {
  std::size_t k = 0;
  while (k < 2 && has_corner(t, s.ids[k])) ++k;
  return s.corners[k];
}

/// Whether all corners of t that s does not have are strictly on one side of s. Then only what is shared can meet.
bool is_beside(const MeshTriangle& t, const MeshTriangle& s) {
  int side = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (has_corner(s, t.ids[k])) continue;
    const int here = side_of_plane(s.corners[0], s.corners[1], s.corners[2], t.corners[k]);
    if (here == 0 || here == -side) return false;
    side = here;
  }
  return side != 0;
}

bool meet_beside_shared(const MeshTriangle& s, const MeshTriangle& t, const Shape& s_shape, const Shape& t_shape) {
  const Shared shared = shared_corners(s, t);
  if (shared.count == 3) return true;
  if (shared.count == 0) return any_edge_meets(s_shape, t_shape) || any_edge_meets(t_shape, s_shape);
  const auto& [u, v] = shared.places;
  if (shared.count == 2 && u != v)
    return meet_beside_edge(s_shape, t_shape, shared.places, other_corner(s, t), other_corner(t, s));
  return opposite_meets(s_shape, u, t_shape) || opposite_meets(t_shape, u, s_shape);
}

/// Whether an edge of s has all of t, which lies in the same plane, on its other side or on its line.
bool edge_parts(const Shape& s, const Shape& t) {
  const int axis = s.across();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f &a = s.corner(k), &b = s.corner(k + 1);
    const int inside = turn(a, b, s.corner(k + 2), axis);
    if (inside * turn(a, b, t.corner(0), axis) <= 0 && inside * turn(a, b, t.corner(1), axis) <= 0 &&
        inside * turn(a, b, t.corner(2), axis) <= 0)
      return true;
  }
  return false;
}

/// The corner that is alone on its side of a plane, and that side. @param sides  of which some are 1 and some are -1
std::size_t lone_corner(const Signs& sides, int& side) {
  side = sides[0] + sides[1] + sides[2] > 0 ? -1 : 1;
  if (sides[0] + sides[1] + sides[2] == 0) side = 1;  // 1, 0, -1 in some order
  return static_cast<std::size_t>(std::find(sides.begin(), sides.end(), side) - sides.begin());
}

/// Whether the insides of two triangles with area meet.
///
/// Each must have corners on both sides of the other's plane. Then both cut the line of the planes in an interval; its
/// ends lie on the two edges at the corner that is alone on its side. Seen along the line, with both triangles turned
/// so that their lone corners are on the positive side of the other, the order of two ends is the orientation of the
/// four corners of their edges.
bool insides_meet(const Shape& s, const Shape& t) {
  if (!s.has_area() || !t.has_area()) return false;
  const Signs s_sides = t.sides_of(s), t_sides = s.sides_of(t);
  if (s_sides == Signs{0, 0, 0}) return !edge_parts(s, t) && !edge_parts(t, s);
  const auto both = [](const Signs& sides) { return std::minmax({sides[0], sides[1], sides[2]}) == std::pair{-1, 1}; };
  if (!both(s_sides) || !both(t_sides)) return false;
  int s_side = 0, t_side = 0;
  const std::size_t i = lone_corner(s_sides, s_side), j = lone_corner(t_sides, t_side);
  // A triangle whose lone corner is on the negative side of the other turns the other over.
  const std::size_t s_next = t_side > 0 ? i + 1 : i + 2, s_last = t_side > 0 ? i + 2 : i + 1;
  const std::size_t t_next = s_side > 0 ? j + 1 : j + 2, t_last = s_side > 0 ? j + 2 : j + 1;
  return side_of_plane(s.corner(i), s.corner(s_next), t.corner(j), t.corner(t_next)) < 0 &&
         side_of_plane(s.corner(i), s.corner(s_last), t.corner(t_last), t.corner(j)) < 0;
}

/// The middle of points.
struct Mean {
  Vec3d sum{};
  int count = 0;

  void add(const Vec3d& p) {
    sum += p;
    ++count;
  }
};

/// Adds the corners of s that lie in t, and where edges of s pass from one side of t to the other inside of it.
void add_common(const Shape& s, const Shape& t, Mean& mean) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f &a = s.corner(k), &b = s.corner(k + 1);
    if (t.contains(a)) mean.add(to_double(a));
    if (t.side_of(a) * t.side_of(b) >= 0 || !t.meets(a, b)) continue;
    const Vec3d p = to_double(t.corner(0)), q = to_double(t.corner(1)), r = to_double(t.corner(2));
    const Vec3d normal = cross(q - p, r - p);
    const double at_a = std::abs(dot(to_double(a) - p, normal));
    const double at_b = std::abs(dot(to_double(b) - p, normal));
    const double share = at_a + at_b > 0 ? at_a / (at_a + at_b) : 0.5;
    mean.add(to_double(a) + share * (to_double(b) - to_double(a)));
  }
}

/// The middle of what two intervals have in common.
double middle_of_overlap(std::array<float, 3> a, std::array<float, 3> b) {
  const auto [a_low, a_high] = std::minmax({a[0], a[1], a[2]});
  const auto [b_low, b_high] = std::minmax({b[0], b[1], b[2]});
  return 0.5 * (static_cast<double>(std::max(a_low, b_low)) + static_cast<double>(std::min(a_high, b_high)));
}

/// The side of the edge from a to b that `inner` is on has nothing of t but corners that it shares with s: the quick
/// way to part neighbours in one plane.
bool edge_parts_strictly(const MeshTriangle& s, std::size_t k, const MeshTriangle& t, int axis) {
  const Vec3f &a = s.corners[k], &b = s.corners[(k + 1) % 3];
  const int inner = turn(a, b, s.corners[(k + 2) % 3], axis);
  for (std::size_t i = 0; i < 3; ++i) {
    const bool on_edge = t.ids[i] == s.ids[k] || t.ids[i] == s.ids[(k + 1) % 3];
    if (!on_edge && turn(a, b, t.corners[i], axis) * inner >= 0) return false;
  }
  return true;
}

/// Whether an edge of s, which has area and lies in one plane with t, has all of t beyond it, shared corners apart.
bool any_edge_parts_strictly(const MeshTriangle& s, const Shape& s_shape, const MeshTriangle& t) {
  for (std::size_t k = 0; k < 3; ++k)
    if (edge_parts_strictly(s, k, t, s_shape.across())) return true;
  return false;
}

}  // namespace

Vec3d place_of_contact(const MeshTriangle& s, const MeshTriangle& t) {
  const Shape s_shape(s.corners), t_shape(t.corners);
  Mean mean;
  add_common(s_shape, t_shape, mean);
  add_common(t_shape, s_shape, mean);
  if (mean.count > 0) return 1.0 / mean.count * mean.sum;
  // In one plane, no corner of one in the other: only edges cross.
  const auto& [a, b, c] = s.corners;
  const auto& [d, e, f] = t.corners;
  return {middle_of_overlap({a.x, b.x, c.x}, {d.x, e.x, f.x}), middle_of_overlap({a.y, b.y, c.y}, {d.y, e.y, f.y}),
          middle_of_overlap({a.z, b.z, c.z}, {d.z, e.z, f.z})};
}

Contact contact_of(const MeshTriangle& s, const MeshTriangle& t) {
  if (is_beside(t, s) || is_beside(s, t)) return Contact::none;
  const Shape s_shape(s.corners), t_shape(t.corners);
  const bool in_plane = s_shape.has_area() && t_shape.has_area() && s_shape.sides_of(t_shape) == Signs{0, 0, 0};
  if (in_plane && (any_edge_parts_strictly(s, s_shape, t) || any_edge_parts_strictly(t, t_shape, s)))
    return Contact::none;
  if (!meet_beside_shared(s, t, s_shape, t_shape)) return Contact::none;
  return insides_meet(s_shape, t_shape) ? Contact::crossing : Contact::touching;
}

}  // namespace pointskin::mesh_detail
