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

#include "scene/sources.hpp"

namespace pointskin::cli {

using scene::check_not_empty;
using scene::MissingNormals;

/// scene::read_clouds, whose notices are printed as warnings.
Cloud read_clouds(const std::vector<std::string>& paths, const ReadOptions& options,
                  MissingNormals missing = MissingNormals::refused);

/// Warns of points that were left out on reading, if there are any. @param prefix  of the warning
void warn_about_dropped(std::int64_t count, const std::string& prefix = "");

/// Warns of points that were left out because their normal is zero, if there are any.
void warn_about_zero_normals(std::int64_t count, const std::string& prefix = "");

/// scene::drop_zero_normals, with a warning for what was left out on reading and one for what is now.
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

/// Says that --colors finds none.
void warn_about_no_colours();

/// Reads `path` as a mesh if it is a PLY with faces or another mesh format, else as a cloud. "-" is stdin.
/// A mesh format without faces gives a cloud of its vertices.
/// @throws Error as read_mesh and read_cloud
std::variant<Cloud, Mesh> read_cloud_or_mesh(const std::string& path, const ReadOptions& options);

}  // namespace pointskin::cli
