// Points to implicit function: what reconstruction, editing, Booleans and deformation share.
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
#include "reconstruct/points.hpp"
#include "reconstruct/weakness.hpp"

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
  FieldSamples samples;                   ///< with FitSetup::keeps_samples()
  bool keeps_all = false;                 ///< FitSetup::keep_all
  bool drops_specks = false;              ///< FitSetup::drop_specks
  double fitting_trim = 0;                ///< where a trim was or may be chosen
  double trim = 0;                        ///< Options::trim, or what was chosen; not with keeps_all
  float trim_limit = 0;                   ///< spacing in finest cells, with a trim; not with keeps_all
  WeaknessScale weakness;                 ///< with Options::weakness; not with keeps_all
  exec::Buffer<diagnose::Counts> counts;  ///< with FitSetup::look
  diagnose::Counts seen{};                ///< these, as they were read last
  /// With FitSetup::look, if the cube was made for outliers: the box of the samples that are none. A cube for it shows more.
  std::optional<Bounds> core;

  [[nodiscard]] field::FieldView view(DomainFaces faces) const { return view(faces, isovalue); }
  [[nodiscard]] field::FieldView view(DomainFaces faces, double at) const {
    return {resolution.view(tree), values.data(), static_cast<float>(at), faces == DomainFaces::closed,
            resolution.bricks.data()};
  }
};

/// What a fit depends on besides the points and the options.
struct FitSetup {
  bool keep_points = false;                ///< false: `points` are freed once they are sorted
  std::optional<octree::Extent> extent{};  ///< of the points, where it is known
  std::optional<octree::Frame> cube{};     ///< the working cube, for all points; unset: fitted, and strays are left out
  /// What FieldData::core said of a fit of these points: the cube is made for it, and points outside are left out.
  std::optional<Bounds> core{};
  std::shared_ptr<const envelope::Envelope> envelope{};  ///< made ready from Options::envelope, or null
  bool keep_samples = false;                             ///< fill FieldData::samples
  bool keep_all = false;                                 ///< whatever any ExtractOptions need: they come later
  bool look = false;                                     ///< count what may be wrong, FieldData::seen
  bool drop_specks = false;  ///< pieces without samples go, also where there are no outliers
  /// Of nearly the same points, or null. It is started from if its cube and depth are the same, with three
  /// quarters of the iterations (docs/decisions/0023-editing.md).
  const FieldData* before = nullptr;

  [[nodiscard]] bool keeps_samples() const { return keep_samples || keep_all; }
};

/// Points to implicit function (P1 to P8). The report's places are relative to the cloud's origin.
/// Points of PointBuffers::added take part in all but the isovalue.
/// @throws Error empty_result (all points at one place, or outside of the envelope), over_limit, interrupted
template <exec::Space Exec>
FieldData fit_field(Exec& ex, PointBuffers& points, const FitSetup& setup, const Options& options, RunReport& report);

/// FieldData::samples of a fit, anew, from its points and its cube: a field that waits need not keep them. O(points).
template <exec::Space Exec>
FieldSamples samples_of(Exec& ex, const PointBuffers& points, const octree::Frame& cube);

}  // namespace pointskin::detail
