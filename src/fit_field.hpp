// Points to implicit function to surface, on one space: what reconstruction, editing, Booleans and deformation share.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <memory>
#include <optional>

#include "envelope/envelope.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/attributes.hpp"
#include "field/field_view.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "points.hpp"
#include "poisson/density.hpp"
#include "poisson/resolution.hpp"
#include "reconstruct_engine.hpp"
#include "surface/extract.hpp"
#include "weakness.hpp"

namespace pointskin::detail {

/// Everything that is known of a field after the solve. Places are relative to the cloud's origin.
struct FieldData {
  octree::Frame frame;
  octree::OctreeData tree;
  poisson::Resolution resolution;
  exec::Buffer<float> values;
  poisson::Density density;
  field::AttributeSamples attributes;                  ///< without positions unless there are channels
  std::shared_ptr<const envelope::Envelope> envelope;  ///< with Options::envelope
  double isovalue = 0;
  float trim_limit = 0;    ///< spacing in finest cells, with Options::trim
  WeaknessScale weakness;  ///< with Options::weakness

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
};

/// Points to implicit function (P1 to P8). The report's places are relative to the cloud's origin.
/// Points of DevicePoints::added take part in all but the isovalue.
/// @throws Error empty_result (all points at one place, or outside of the envelope), over_limit, interrupted
template <exec::Space Exec>
FieldData fit_field(Exec& ex, DevicePoints& points, const FitSetup& setup, const Options& options, RunReport& report);

/// Implicit function to mesh, on the device (P9).
/// @param report  receives what was cut, with Options::trim, and what was moved, with an envelope
template <exec::Space Exec>
surface::Surface extract(Exec& ex, const FieldData& field, const Options& options, RunReport& report);

/// `data` as what a Field delegates to.
/// @param origin  of the cloud: what places in `data` are relative to
template <exec::Space Exec>
std::shared_ptr<FieldImpl> make_field(std::shared_ptr<Exec> ex, FieldData data, const Options& options,
                                      const Vec3d& origin);

}  // namespace pointskin::detail
