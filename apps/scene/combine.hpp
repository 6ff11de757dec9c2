// Points of the scene that a set operation has kept, known again.
#pragma once

#include <pointskin/boolean.hpp>
#include <pointskin/cloud.hpp>

namespace pointskin::scene {

/// The attribute of points that says where they come from (EditSession::cloud).
inline constexpr char kAdded[] = "added";

/// Gives result.cloud the attributes of A: points of A keep their values, all others have none, but for "added", where
/// they are original. If no point is an original one then, all are.
/// @param a  the first operand, with "added"
/// O(points).
void carry_attributes(const Cloud& a, BooleanResult& result);

/// `cloud` or `mesh` without the attribute "added". O(attributes).
void drop_added(std::vector<Attribute>& attributes);

}  // namespace pointskin::scene
