// Implicit function to mesh: what reconstruction, editing, Booleans and deformation share.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <pointskin/device_data.hpp>
#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include "exec/space.hpp"
#include "exec/typed_buffer.hpp"
#include "reconstruct/fit_field.hpp"
#include "surface/extract.hpp"

namespace pointskin::detail {

/// Share of curvature that a crossing takes (surface/edge_vertex.hpp). The screening pulls the trilinear function to
/// the samples, whose own crossing is linear; the smooth function that it stands for is curved. Halfway is nearest to
/// the surface (docs/decisions/0017-noise-and-smoothness.md).
inline constexpr float kCurvature = 0.5F;

/// A mesh in a space, in world units relative to an origin.
struct MeshBuffers {
  surface::Surface surface;
  std::vector<std::string> names;  ///< of the attributes
  std::vector<exec::TypedBuffer> attributes;
};

/// Implicit function to mesh, on the device (P9).
/// @param report  receives what was cut, with Options::trim, and what was moved, with an envelope
template <exec::Space Exec>
surface::Surface extract(Exec& ex, const FieldData& field, const Options& options, RunReport& report);

/// Counts what may be wrong with a surface of `field`, if its fit was looked at; FieldData::seen. Waits.
template <exec::Space Exec>
void look_at_surface(Exec& ex, const surface::Surface& surface, FieldData& field);

/// The same, with triangles.
/// @throws Error empty_result if nothing crosses the isovalue, or nothing is left after Options::trim
template <exec::Space Exec>
surface::Surface extract_some(Exec& ex, const FieldData& field, const Options& options, RunReport& report);

/// @param report  of how the surface came to be
/// @throws Error empty_result, with the reason, if there are no triangles
inline void check_triangles(std::int64_t triangles, const RunReport& report) {
  if (triangles > 0) return;
  if (report.pieces.pieces > 0)
    throw Error(ErrorCode::empty_result, "all pieces of the surface are smaller than min-component");
  if (report.trim.triangles_before > 0)
    throw Error(ErrorCode::empty_result,
                "all of the surface was trimmed away; choose a smaller trim quantile or island ratio");
  throw Error(ErrorCode::empty_result, "the surface has no triangles; are the normals oriented consistently?");
}

/// Copies a surface of `field` to the host, in world units relative to `origin`, with attributes and density.
/// @param mesh  receives it; its memory is used again
template <exec::Space Exec>
void download_mesh(Exec& ex, const FieldData& field, surface::Surface surface, const Options& options,
                   const Vec3d& origin, Mesh& mesh);

/// Surface to mesh on the host, for the last time: of `field` only FieldData::seen is left, freed before the mesh is
/// copied.
/// @param origin  of the cloud: what places in `field` are relative to
/// @param report  receives extract_ms, download_ms, the peak memory and what was cut and moved
/// @throws Error as extract_some
template <exec::Space Exec>
void extract_and_release(Exec& ex, FieldData& field, const Options& options, const Vec3d& origin, Mesh& mesh,
                         RunReport& report);

/// A surface of `field` in world units, with attributes, density and weakness, where the space works.
/// @throws Error as extract_some
template <exec::Space Exec>
MeshBuffers mesh_in_space(Exec& ex, const FieldData& field, surface::Surface surface, const Options& options);

/// Copies a mesh that is in the space to the host.
template <exec::Space Exec>
Mesh download_mesh_of(Exec& ex, const DeviceMesh& mesh);

/// The field at points in world coordinates; see Field::values.
/// @param origin  of the cloud
template <exec::Space Exec>
std::vector<float> values_at(Exec& ex, const FieldData& field, const Vec3d& origin, std::span<const Vec3d> points);

}  // namespace pointskin::detail
