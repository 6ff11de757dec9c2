// Options that were given and have no effect: each is said in a warning.
#pragma once

#include <initializer_list>
#include <string>

#include <pointskin/cloud.hpp>
#include <pointskin/normals.hpp>
#include <pointskin/reconstruct.hpp>

#include "given_options.hpp"

namespace pointskin::cli {

/// Warns of each of `options` that was given: "--seed has no effect `why`".
void warn_unused(const GivenOptions& given, std::initializer_list<const char*> options, const std::string& why);

/// Why options of the mesh have none.
inline constexpr char kNoMesh[] = "where no mesh is written";

/// Options of the surface that others switch off, or that the mesh's file `output` cannot hold.
/// @param reports  a report tells of problems where a mesh cannot
void warn_about_unused(const GivenOptions& given, const Options& options, const std::string& output, bool reports);

/// --ascii where `output` is no PLY.
void warn_about_ascii(const GivenOptions& given, const std::string& output);

/// Options of the normals where none are estimated.
void warn_about_unused_normals(const GivenOptions& given);
/// The same once they are, by `used`.
void warn_about_unused_normals(const GivenOptions& given, NormalMethod used);

/// Options that these points leave without effect, or without much: lengths of normals that are all alike, properties
/// that are not there, or that the file of the mesh cannot hold. O(points).
void warn_about_unused(const GivenOptions& given, const Options& options, const Cloud& cloud,
                       const std::string& output);

/// How many points lie outside of the bounding box of `mesh`, and so outside of it.
std::int64_t count_outside_box(const Cloud& cloud, const Mesh& mesh);

/// Warns if most of `points` lie outside of the envelope.
void warn_about_envelope(const EnvelopeReport& envelope, std::int64_t points);

}  // namespace pointskin::cli
