#include "reconstruct/fit_field.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/announce.hpp"
#include "diagnose/look.hpp"
#include "diagnose/verdict.hpp"
#include "exec/this_space.hpp"
#include "field/distance.hpp"
#include "octree/bounding_box.hpp"
#include "poisson/boundary.hpp"
#include "poisson/divergence.hpp"
#include "poisson/screening.hpp"
#include "poisson/solve.hpp"
#include "poisson/trust.hpp"
#include "reconstruct/fit_cube.hpp"
#include "reconstruct/offset_surface.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/pieces_by_support.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/trim_to_samples.hpp"
#include "reconstruct/within_envelope.hpp"

namespace pointskin::detail {
namespace {

void report_levels(const octree::OctreeData& tree, const std::vector<poisson::LevelSolve>& levels, RunReport& report) {
  const octree::OctreeView view = tree.view();
  report.depth = tree.depth;
  report.nodes = tree.cells();
  report.levels.clear();
  for (const poisson::LevelSolve& level : levels)
    report.levels.push_back({level.depth, view.levels[level.depth].cells(), level.unknowns, level.iterations,
                             level.residual_before, level.residual_after});
}

/// The unknowns to solve for, where some are held at 0; else none.
template <exec::Space Exec>
exec::Buffer<std::uint8_t> find_free_unknowns(Exec& ex, const octree::OctreeView& tree, const FieldData& field,
                                              const Options& options) {
  exec::Buffer<std::uint8_t> free;
  const bool hold_faces = options.boundary == Boundary::dirichlet;
  if (hold_faces || field.envelope != nullptr) free = poisson::free_unknowns(ex, tree, hold_faces);
  if (field.envelope != nullptr) hold_outside(ex, *field.envelope, field.frame, tree, free.view());
  return free;
}

bool may_start_from(const FieldData& before, const FieldData& field) {
  return before.values.data() != nullptr && before.frame == field.frame && before.tree.depth == field.tree.depth;
}

/// Keeps what the fit needs no longer, or copies.
template <exec::Space Exec>
void keep_samples(Exec& ex, const poisson::Samples& samples, exec::Buffer<std::uint8_t> added, FieldSamples& kept) {
  kept.positions = exec::make_buffer<Vec3f>(ex, samples.positions.size());
  copy(ex, samples.positions.cview(), kept.positions.view());
  kept.added = std::move(added);
}

/// Areas of the samples that decide on the isovalue: 0 for those that were added.
struct AreaUnlessAdded {
  ArrayView<const float> areas_in;
  ArrayView<const std::uint8_t> added;
  ArrayView<float> areas;
  PSK_HD void operator()(std::int64_t i) const { areas[i] = added[i] != 0 ? 0.0F : areas_in[i]; }
};

/// Mean of the field at the samples that were not added, with an envelope at those inside.
/// @param added  as SortedSamples::added
template <exec::Space Exec>
double find_isovalue(Exec& ex, const FieldData& field, ArrayView<const float> u, const poisson::Samples& samples,
                     ArrayView<const std::uint8_t> added, RunReport& report) {
  poisson::SamplesView view = samples.view();
  exec::Buffer<float> areas;
  if (!added.empty()) {
    areas = exec::make_buffer<float>(ex, added.size);
    for_each(ex, "solve.isovalue", added.size, AreaUnlessAdded{view.areas, added, areas.view()});
    view.areas = areas.cview();
  }
  if (field.envelope == nullptr) return poisson::mean_at_samples(ex, field.tree, u, view);
  const exec::Buffer<float> inside =
      areas_inside(ex, *field.envelope, field.frame, view, report.envelope.samples_outside);
  view.areas = inside.cview();
  const double isovalue = poisson::mean_at_samples(ex, field.tree, u, view);
  if (!(isovalue > 0))  // all that is held at 0 would be inside
    throw Error(ErrorCode::empty_result,
                "the field is not positive at the points; are their normals oriented outwards, away from the inside?");
  return isovalue;
}

/// Looks at the samples, and settles what to trim.
template <exec::Space Exec>
void look_at_samples(Exec& ex, const poisson::Samples& samples, const FitSetup& setup, const Options& options,
                     FieldData& field) {
  const bool chooses = setup.keep_all || options.trim == Options::kAutomaticTrim;
  if (setup.look || chooses) {
    field.counts = diagnose::make_counts(ex);
    diagnose::look_at_samples(ex, field.tree.view(), field.density, samples.view(), field.counts);
  }
  if (chooses)
    field.fitting_trim = diagnose::fitting_trim(diagnose::findings_of(diagnose::read_counts(ex, field.counts)));
  if (setup.keep_all) return;  // a trim is settled when a surface is asked for
  field.trim = options.trim == Options::kAutomaticTrim ? field.fitting_trim : options.trim;
  if (field.trim > 0)
    field.trim_limit =
        trim_limit(ex, field.tree, field.density, samples.positions.cview(), samples.normals.cview(), field.trim);
}

/// Looks at the solved field, and reads all that was counted.
template <exec::Space Exec>
void look_at_fit(Exec& ex, const poisson::Samples& samples, const Options& options, FieldData& field) {
  diagnose::look_at_field(ex, field.view(options.domain_faces), samples.view(), field.counts);
  field.seen = diagnose::read_counts(ex, field.counts);
}

/// The box of a sample, and none of an outlier.
struct BoxOfInlier {
  ArrayView<const Vec3f> positions;
  ArrayView<const float> areas;
  PSK_HD Bounds operator()(std::int64_t i) const {
    constexpr float kFar = 2;  // beyond the unit cube
    if (areas[i] > 0) return {positions[i], positions[i]};
    return {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  }
};

/// FieldData::core. Waits where some samples are lonely; elsewhere nothing is done.
template <exec::Space Exec>
std::optional<Bounds> find_core(Exec& ex, const poisson::Samples& samples, const Options& options,
                                const FieldData& field) {
  if (diagnose::findings_of(field.seen).lonely <= 0) return std::nullopt;
  const Bounds box =
      exec::reduce<Bounds>(ex, "octree.core", samples.areas.size(),
                           BoxOfInlier{samples.positions.cview(), samples.areas.cview()}, octree::JoinBoxes{});
  return core_in(box, field.frame, options.scale);
}

/// The tangent planes of the samples that are no outliers.
struct Planes {
  exec::Buffer<Vec3f> normals;
  exec::Buffer<float> weights;  ///< with Options::confidence
};

template <exec::Space Exec>
Planes planes_of(Exec& ex, const poisson::Samples& samples, exec::Buffer<float> weights) {
  Planes planes{exec::make_buffer<Vec3f>(ex, samples.normals.size()), std::move(weights)};
  copy(ex, samples.normals.cview(), planes.normals.view());
  field::drop_planes_of_outliers(ex, samples.areas.cview(), planes.normals.view());
  return planes;
}

/// Solved field to signed distance (P10): distances to planes, on the sides that the solved field tells.
template <exec::Space Exec>
void measure_distances(Exec& ex, ArrayView<const Vec3f> positions, const Planes& planes, FieldData& field) {
  field.values = field::distance_to_planes(ex, field.tree, {positions, planes.normals.cview(), planes.weights.cview()},
                                           {field.values.data(), static_cast<float>(field.isovalue)});
  field.isovalue = 0;
  field.resolution = {};
}

/// Samples to the screened Poisson field (P4 to P8), and on to the signed distance (P10) if that is asked for, once frame,
/// tree and channels of `field` are there.
template <exec::Space Exec>
void fit_samples(Exec& ex, SortedSamples& sorted, const FitSetup& setup, const Options& options, FieldData& field,
                 RunReport& report) {
  PhaseClock clock(ex);
  poisson::Samples& samples = sorted.samples;
  const bool has_attributes = !field.attributes.names.empty();
  const bool is_distance = options.field == FieldKind::distance;
  announce(options.progress, "splat", 0.25);
  exec::Buffer<float> weights;
  if ((has_attributes || is_distance) && options.confidence)
    weights = poisson::confidence_weights(ex, samples.normals.cview());
  field.density = poisson::weigh_samples(ex, field.tree, {options.samples_per_node, options.confidence}, samples);
  field.resolution = poisson::find_resolution(ex, field.tree, samples);
  Planes planes;
  if (is_distance) planes = planes_of(ex, samples, std::move(weights));
  look_at_samples(ex, samples, setup, options, field);
  const bool keeps_density = options.density || options.weakness || options.trim != 0 || setup.keep_all;
  if (!keeps_density && !setup.look && !setup.drop_specks) field.density.counts.reset();
  if (options.screening > 0 && !options.fixed_screening)
    poisson::weigh_trust(ex, field.tree, samples);
  else
    samples.trust.reset();
  exec::Buffer<float> divergence = poisson::splat_divergence(ex, field.tree, samples.view(), field.resolution);
  if (setup.keeps_samples()) field.samples.normals = std::move(samples.normals);
  samples.normals.reset();
  poisson::Screening screening;
  if (options.screening > 0) screening = poisson::collapse_samples(ex, field.tree, samples.view());
  samples.trust.reset();
  clock.lap(report.splat_ms);

  poisson::SolveOptions solving{options.screening, options.iterations, options.residuals};
  solving.before_level = [&](int depth) {  // every level costs about four times the one before
    announce(options.progress, "solve", 0.45 + 0.35 * std::pow(4.0, depth - options.depth - 1));
  };
  const octree::OctreeView tree = field.resolution.view(field.tree);
  exec::Buffer<std::uint8_t> free_unknowns = find_free_unknowns(ex, tree, field, options);
  solving.free_unknowns = free_unknowns.cview();
  exec::Buffer<std::int32_t> matches;
  if (setup.before != nullptr && !is_distance && may_start_from(*setup.before, field)) {
    solving.previous.tree = setup.before->resolution.view(setup.before->tree);
    solving.previous.u = setup.before->values.data();
    matches = poisson::match_bricks(ex, tree, solving.previous.tree);
    solving.previous.bricks = matches.data();
    solving.iterations = (3 * options.iterations + 3) / 4;
  }
  poisson::Solution solution = poisson::solve_poisson(ex, tree, divergence.cview(), screening, solving);
  matches.reset();
  free_unknowns.reset();
  divergence.reset();
  screening = {};
  field.isovalue = find_isovalue(ex, field, solution.u.cview(), samples, sorted.added.cview(), report);
  field.values = std::move(solution.u);
  if (is_distance) measure_distances(ex, samples.positions.cview(), planes, field);
  if (!field.counts.empty()) look_at_fit(ex, samples, options, field);
  if (setup.look && !setup.cube && !setup.core && !options.keep_strays)
    field.core = find_core(ex, samples, options, field);
  if (!keeps_density && !picks_pieces_by_support(field, options)) field.density.counts.reset();
  if (setup.keeps_samples()) keep_samples(ex, samples, std::move(sorted.added), field.samples);
  if (options.weakness)
    field.weakness = weakness_scale(ex, field.tree, field.density, field.values.data(), samples.positions.cview());
  if (has_attributes) {
    field.attributes.weights = std::move(is_distance ? planes.weights : weights);
    field.attributes.positions = std::move(samples.positions);
  }
  clock.lap(report.solve_ms);
  clock.read();

  report.isovalue = field.isovalue;
  report_levels(field.tree, solution.levels, report);
}

/// The field of the options, without an offset.
template <exec::Space Exec>
FieldData fit_to_points(Exec& ex, PointBuffers& points, const FitSetup& setup, const Options& options,
                        RunReport& report) {
  PhaseClock clock(ex);
  FieldData field;
  field.envelope = setup.envelope;
  field.keeps_all = setup.keep_all;
  field.drops_specks = setup.drop_specks;
  announce(options.progress, "octree", 0.05);
  field.frame = setup.cube   ? *setup.cube
                : setup.core ? cube_around(ex, *setup.core, points, options, report)
                             : fit_cube(ex, points, options, report, setup.extent);
  report.points = points.used_count();
  SortedSamples sorted = sort_into_cube(ex, points, field.frame);
  field.attributes = std::move(sorted.attributes);
  if (!setup.keep_points) points = {};
  field.tree = octree::build_octree(ex, sorted.keys.cview(), options.depth);
  sorted.keys.reset();
  clock.lap(report.octree_ms);
  fit_samples(ex, sorted, setup, options, field, report);
  clock.read();
  return field;
}

}  // namespace

template <exec::Space Exec>
FieldData fit_field(Exec& ex, PointBuffers& points, const FitSetup& setup, const Options& options, RunReport& report) {
  FieldData field = fit_to_points(ex, points, setup, options, report);
  if (options.offset == 0) return field;
  announce(options.progress, "solve", 0.8);
  FieldData offset = offset_surface(ex, field, options, report);
  offset.seen = field.seen;
  return offset;
}

template <exec::Space Exec>
FieldSamples samples_of(Exec& ex, const PointBuffers& points, const octree::Frame& cube) {
  SortedSamples sorted = sort_into_cube(ex, points, cube);
  field::normalise(ex, sorted.samples.normals.view());
  return {std::move(sorted.samples.positions), std::move(sorted.samples.normals), std::move(sorted.added)};
}

PSK_INSTANTIATE(fit_field);
PSK_INSTANTIATE(samples_of);

}  // namespace pointskin::detail
