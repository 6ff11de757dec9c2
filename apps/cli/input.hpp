// Reading what the commands work on: merged clouds, and files that may hold a cloud or a mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

namespace pointskin::cli {

/// Whether clouds may come without normals. If some do, the merged cloud has none.
enum class MissingNormals { refused, allowed };

/// Reads `paths` and merges them (merge_into). O(points).
/// @throws Error as read_cloud; no_normals if that is refused; empty_result if a merged cloud would have no points,
/// invalid_input if all were dropped
Cloud read_clouds(const std::vector<std::string>& paths, const ReadOptions& options,
                  MissingNormals missing = MissingNormals::refused);

/// @param name  of the file, for the story
/// @throws Error empty_result if the cloud has no points, invalid_input if all were dropped on reading
void check_not_empty(const Cloud& cloud, const std::string& name);

/// Removes points whose normal has zero length and counts them in Cloud::dropped.
/// @returns how many
/// @throws Error no_normals if the cloud has no normals, or none that is not zero
std::int64_t drop_zero_normals(Cloud& cloud);

/// Warns of points that were left out on reading, if there are any. @param prefix  of the warning
void warn_about_dropped(std::int64_t count, const std::string& prefix = "");

/// drop_zero_normals, with a warning for what was left out on reading and one for what is now.
/// @param prefix  of the warnings
void drop_unusable(Cloud& cloud, const std::string& prefix = "");

/// Reads the mesh that a surface is to stay inside of. @returns null for no name
/// @throws Error as read_mesh; invalid_input if it has no triangles
std::shared_ptr<const Mesh> read_envelope(const std::string& path, int threads);

/// What to tell of strays that are left out: how many, where the farthest is in world units, and how to keep them.
std::string strays_text(std::int64_t count, const Vec3d& farthest);

/// Warns of the strays of `cloud`, if there are any.
void warn_about_strays(const Cloud& cloud, int threads);

/// True for red, green and blue.
bool is_colour(const Attribute& attribute);

/// Leaves only the attributes red, green and blue.
/// @returns whether there are any
bool keep_colours_only(Cloud& cloud);

/// Reads `path` as a mesh if it is a PLY with faces or another mesh format, else as a cloud. "-" is stdin.
/// A mesh format without faces gives a cloud of its vertices.
/// @throws Error as read_mesh and read_cloud
std::variant<Cloud, Mesh> read_cloud_or_mesh(const std::string& path, const ReadOptions& options);

}  // namespace pointskin::cli
