// Points to implicit function to surface, on one space: what reconstruction, editing, Booleans and deformation share.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <cstdint>
#include <memory>
#include <optional>

#include "diagnose/counts.hpp"
#include "envelope/envelope.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/attributes.hpp"
#include "field/field_view.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "poisson/density.hpp"
#include "poisson/resolution.hpp"
#include "reconstruct/engine.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/weakness.hpp"
#include "surface/extract.hpp"

namespace pointskin::detail {

/// The samples of a field in the order of their keys, for what is done with it afterwards.
struct FieldSamples {
  exec::Buffer<Vec3f> positions;     ///< in the unit cube
  exec::Buffer<Vec3f> normals;       ///< unit length or zero
  exec::Buffer<std::uint8_t> added;  ///< as PointBuffers::added
};

/// Everything that is known of a field after the solve. Places are relative to the cloud's origin.
struct FieldData {
  octree::Frame frame;
  octree::OctreeData tree;
  poisson::Resolution resolution;
  exec::Buffer<float> values;
  poisson::Density density;
  field::AttributeSamples attributes;                  ///< without positions unless there are attributes
  std::shared_ptr<const envelope::Envelope> envelope;  ///< with Options::envelope
  double isovalue = 0;
  FieldSamples samples;                   ///< with FitSetup::keep_samples
  double trim = 0;                        ///< Options::trim, or what was chosen
  float trim_limit = 0;                   ///< spacing in finest cells, with Options::trim
  WeaknessScale weakness;                 ///< with Options::weakness
  exec::Buffer<diagnose::Counts> counts;  ///< with FitSetup::look
  diagnose::Counts seen{};                ///< these, as they were read last

  [[nodiscard]] field::FieldView view(DomainFaces faces) const {
    return {resolution.view(tree), values.data(), static_cast<float>(isovalue), faces == DomainFaces::closed,
            resolution.bricks.data()};
  }
};

/// What a fit depends on besides the points and the options.
struct FitSetup {
  bool keep_points = false;             ///< false: `points` are freed once they are sorted
  std::optional<octree::Frame> cube{};  ///< the working cube, for all points; unset: fitted, and strays are left out
  std::shared_ptr<const envelope::Envelope> envelope{};  ///< made ready from Options::envelope, or null
  bool keep_samples = false;                             ///< fill FieldData::samples
  bool look = false;                                     ///< count what may be wrong, FieldData::seen
  /// Of nearly the same points, or null. It is started from if its cube and depth are the same, with three
  /// quarters of the iterations (docs/decisions/0023-editing.md).
  const FieldData* before = nullptr;
};

/// Points to implicit function (P1 to P8). The report's places are relative to the cloud's origin.
/// Points of PointBuffers::added take part in all but the isovalue.
/// @throws Error empty_result (all points at one place, or outside of the envelope), over_limit, interrupted
template <exec::Space Exec>
FieldData fit_field(Exec& ex, PointBuffers& points, const FitSetup& setup, const Options& options, RunReport& report);

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

/// `data` as what a Field delegates to.
/// @param origin  of the cloud: what places in `data` are relative to
template <exec::Space Exec>
std::shared_ptr<FieldImpl> make_field(std::shared_ptr<Exec> ex, FieldData data, const Options& options,
                                      const Vec3d& origin);

}  // namespace pointskin::detail
