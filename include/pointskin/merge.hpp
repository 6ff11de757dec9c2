// Clouds made of others: scans joined to one cloud, points left out, the vertices of meshes.
#pragma once

#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin PSK_EXPORT {

/// Adds the points of `more` behind those of `cloud`, whose own come first and keep their order.
///
/// World positions stay what they are, up to the rounding of float: where the origins differ, the one of the two is
/// kept around which float loses less (the distance to the middle of each cloud's box, times its points), and the other
/// cloud's positions are moved to it. Normals are kept if both clouds have them, else there are none. An attribute of
/// one name becomes one attribute, in the smallest type that holds the values of both (common_type); points of the
/// cloud that lacks it have a missing value. Attributes of `cloud` come first, then those that `more` adds. Counts of
/// dropped points add up. A cloud without points adds nothing else: merged with it, the other one stays as it is.
/// Many scans are joined one after the other: `Cloud all; for (Cloud& scan : scans) merge_into(all, std::move(scan));`.
/// @param cloud, more  world units; arrays of shape (n) or (0) as Cloud says
/// O(points of both) time; memory for the result and for `more`. Deterministic: one thread, in the order of the clouds
/// and of their points.
void merge_into(Cloud& cloud, Cloud&& more);

/// Leaves the points where `keep` is true, in their order, with their normals and attributes, and counts the others in
/// Cloud::dropped.
/// @param keep  shape (n)
/// @throws Error usage if the shape differs
/// O(n), in place. Deterministic.
void keep_where(Cloud& cloud, const std::vector<bool>& keep);

/// The vertices of `mesh` with their normals and attributes, which are moved; the triangles are left out. O(1).
Cloud cloud_of_vertices(Mesh&& mesh);

}  // namespace pointskin
