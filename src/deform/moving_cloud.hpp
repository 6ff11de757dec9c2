// A cloud that is deformed again and again from its rest pose: what a Deformer holds, and what it asks of a space.
#pragma once

#include <pointskin/deform.hpp>

#include <memory>
#include <vector>

#include "deform/chosen_points.hpp"
#include "deform/resample.hpp"
#include "deform/rest.hpp"
#include "envelope/envelope.hpp"
#include "exec/space.hpp"

namespace pointskin::deform {

/// The cloud at rest and as it is now, in a space.
struct MovingCloud {
  Options options;  ///< of every frame
  std::shared_ptr<const envelope::Envelope> envelope;
  RestCloud rest;
  Resampled samples;  ///< deformed
  std::vector<ChosenPoints> chosen;
  std::vector<float> rest_distances;  ///< measured when first asked for
};

/// The cloud where it is at rest.
/// @param options  valid
/// @param report   receives upload_ms, rest_ms, rest_points, and what apply reports
template <exec::Space Exec>
MovingCloud start(Exec& ex, const Cloud& cloud, const Options& options, DeformReport& report);

// As Deformer::deform, reconstruct, cloud and spacing.

/// @param deformation  valid
template <exec::Space Exec>
void apply(Exec& ex, const Deformation& deformation, MovingCloud& moving, DeformReport& report);

/// @param moving  the same afterwards: its samples are lent to the fit
template <exec::Space Exec>
void reconstruct(Exec& ex, MovingCloud& moving, Mesh& mesh, DeformReport& report);

template <exec::Space Exec>
Cloud copy_cloud(Exec& ex, const MovingCloud& moving);

template <exec::Space Exec>
SpacingRatios measure_spacing(Exec& ex, MovingCloud& moving);

}  // namespace pointskin::deform
