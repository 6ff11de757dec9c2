#pragma once

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "exec/algorithms.hpp"
#include "field/distance.hpp"
#include "field/evaluate.hpp"
#include "fit_field.hpp"
#include "offset_surface.hpp"
#include "phase_clock.hpp"
#include "points.hpp"
#include "poisson/boundary.hpp"
#include "poisson/divergence.hpp"
#include "poisson/screening.hpp"
#include "poisson/solve.hpp"
#include "poisson/trust.hpp"
#include "trim_to_samples.hpp"
#include "within_envelope.hpp"

namespace pointskin::detail {
namespace fit {

/// Tells the caller where the run is. @throws Error interrupted if it wants to stop
inline void announce(const Options& options, const char* phase, double fraction) {
  if (options.progress && !options.progress({phase, fraction}))
    throw Error(ErrorCode::interrupted, std::string("cancelled before the phase \"") + phase + "\"");
}

inline void report_levels(const octree::OctreeData& tree, const std::vector<poisson::LevelSolve>& levels,
                          RunReport& report) {
  const octree::OctreeView view = tree.view();
  report.depth = tree.depth;
  report.nodes = tree.cells();
  report.levels.clear();
  for (const poisson::LevelSolve& level : levels)
    report.levels.push_back({level.depth, view.levels[level.depth].cells(), level.unknowns, level.iterations,
                             level.residual_before, level.residual_after});
}

inline void report_strays(const octree::StrayPoints& strays, RunReport& report) {
  constexpr std::size_t kListed = 10;
  report.strays = strays.size();
  for (std::size_t i = 0; i < std::min(kListed, strays.positions.size()); ++i) {
    const Vec3f& p = strays.positions[i];
    report.farthest_strays.push_back({p.x, p.y, p.z});
  }
}

/// The working cube; leaves strays out of the points that are used, unless they are to be kept.
template <exec::Space Exec>
octree::Frame fit_cube(Exec& ex, DevicePoints& points, const Options& options, RunReport& report) {
  report.strays = 0;
  report.farthest_strays.clear();
  if (options.keep_strays) return octree::fit_frame(ex, points.positions.cview(), options.scale);
  const octree::StrayPoints strays = octree::find_strays(ex, points.positions.cview());
  report_strays(strays, report);
  leave_out(ex, strays, points);
  return octree::frame_around(strays.core, options.scale);
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

/// The report of a field that nothing was solved for.
inline void report_octree(const octree::OctreeData& tree, RunReport& report) {
  std::vector<poisson::LevelSolve> levels(static_cast<std::size_t>(tree.depth) + 1);
  for (int d = 0; d <= tree.depth; ++d) levels[static_cast<std::size_t>(d)].depth = d;
  report_levels(tree, levels, report);
}

/// Samples to signed distance (P10), once frame, tree and channels of `field` are there.
template <exec::Space Exec>
void fit_distance(Exec& ex, SortedSamples& sorted, const Options& options, PhaseClock<Exec>& clock, FieldData& field,
                  RunReport& report) {
  poisson::Samples& samples = sorted.samples;
  const bool has_attributes = !field.attributes.channels.empty();
  announce(options, "splat", 0.25);
  exec::Buffer<float> weights;
  if (options.confidence) weights = poisson::confidence_weights(ex, samples.normals.cview());
  field::normalise(ex, samples.normals.view());
  if (options.density || options.trim > 0)
    field.density = poisson::splat_density(ex, field.tree, samples.positions.cview());
  if (options.trim > 0) field.trim_limit = trim_limit(ex, field.tree, field.density, samples, options.trim);
  clock.lap(report.splat_ms);

  announce(options, "solve", 0.45);
  field.values =
      field::distance_to_planes(ex, field.tree, {samples.positions.cview(), samples.normals.cview(), weights.cview()});
  field.isovalue = 0;
  if (has_attributes) {
    field.attributes.weights = std::move(weights);
    field.attributes.positions = std::move(samples.positions);
  }
  clock.lap(report.solve_ms);
  clock.read();
  report.isovalue = 0;
  report_octree(field.tree, report);
}

/// The field of the options, without an offset.
template <exec::Space Exec>
FieldData fit_to_points(Exec& ex, DevicePoints& points, const FitSetup& setup, const Options& options,
                        RunReport& report) {
  PhaseClock clock(ex);
  FieldData field;
  field.envelope = setup.envelope;

  fit::announce(options, "octree", 0.05);
  field.frame = setup.cube ? *setup.cube : fit::fit_cube(ex, points, options, report);
  report.points = points.used_count();
  SortedSamples sorted = sort_into_cube(ex, points, field.frame);
  poisson::Samples samples = std::move(sorted.samples);
  field.attributes.channels = std::move(sorted.channels);
  const bool has_attributes = !field.attributes.channels.empty();
  if (!setup.keep_points) points = {};
  field.tree = octree::build_octree(ex, sorted.keys.cview(), options.depth);
  sorted.keys.reset();
  clock.lap(report.octree_ms);
  if (options.field == FieldKind::distance) {
    sorted.samples = std::move(samples);
    fit_distance(ex, sorted, options, clock, field, report);
    return field;
  }

  fit::announce(options, "splat", 0.25);
  if (has_attributes && options.confidence)
    field.attributes.weights = poisson::confidence_weights(ex, samples.normals.cview());
  field.density = poisson::splat_density(ex, field.tree, samples.positions.cview());
  poisson::weigh_samples(ex, field.tree, field.density, {options.samples_per_node, options.confidence}, samples);
  field.resolution = poisson::find_resolution(ex, field.tree, samples);
  if (options.trim > 0) field.trim_limit = trim_limit(ex, field.tree, field.density, samples, options.trim);
  if (!options.density && !options.weakness && options.trim == 0) field.density.counts.reset();
  if (options.screening > 0 && !options.fixed_screening) poisson::weigh_trust(ex, field.tree, samples);
  exec::Buffer<float> divergence = poisson::splat_divergence(ex, field.tree, samples.view(), field.resolution);
  samples.normals.reset();
  poisson::Screening screening;
  if (options.screening > 0) screening = poisson::collapse_samples(ex, field.tree, samples.view());
  samples.trust.reset();
  clock.lap(report.splat_ms);

  const auto before_level = [&](int depth) {  // every level costs about four times the one before
    fit::announce(options, "solve", 0.45 + 0.35 * std::pow(4.0, depth - options.depth - 1));
  };
  const octree::OctreeView tree = field.resolution.view(field.tree);
  exec::Buffer<std::uint8_t> free_unknowns = fit::find_free_unknowns(ex, tree, field, options);
  poisson::Solution solution = poisson::solve_poisson(
      ex, tree, divergence.cview(), screening,
      {options.screening, options.iterations, options.residuals, before_level, free_unknowns.cview()});
  free_unknowns.reset();
  divergence.reset();
  screening = {};
  field.isovalue = fit::find_isovalue(ex, field, solution.u.cview(), samples, sorted.added.cview(), report);
  field.values = std::move(solution.u);
  if (options.weakness)
    field.weakness = weakness_scale(ex, field.tree, field.density, field.values.data(), samples.positions.cview());
  if (has_attributes) field.attributes.positions = std::move(samples.positions);
  clock.lap(report.solve_ms);
  clock.read();

  report.isovalue = field.isovalue;
  fit::report_levels(field.tree, solution.levels, report);
  return field;
}

}  // namespace fit

template <exec::Space Exec>
FieldData fit_field(Exec& ex, DevicePoints& points, const FitSetup& setup, const Options& options, RunReport& report) {
  FieldData field = fit::fit_to_points(ex, points, setup, options, report);
  if (options.offset == 0) return field;
  fit::announce(options, "solve", 0.8);
  return offset_surface(ex, field, options, report);
}

/// Share of curvature that a crossing takes (surface/edge_vertex.hpp). The screening pulls the trilinear function to
/// the samples, whose own crossing is linear; the smooth function that it stands for is curved. Halfway is nearest to
/// the surface (docs/decisions/0017-noise-and-smoothness.md).
inline constexpr float kCurvature = 0.5F;

template <exec::Space Exec>
surface::Surface extract(Exec& ex, const FieldData& field, const Options& options, RunReport& report) {
  const bool trim = options.trim > 0;  // which needs normals
  surface::ExtractOptions extraction{options.linear_fit ? 0 : kCurvature, options.normals || trim};
  if (field.envelope != nullptr) extraction.move_vertices = clip_to(ex, *field.envelope, field.frame, report.envelope);
  surface::Surface surface = surface::extract_surface(ex, field.view(options.domain_faces), extraction);
  if (trim) {
    surface::TrimCounts counts;
    surface = trim_to_samples(ex, field.tree, field.density, std::move(surface),
                              {field.trim_limit, options.island_ratio}, counts);
    report.trim = trim_report(counts, field.frame, field.tree.depth, field.trim_limit);
    if (!options.normals) surface.normals.reset();
  }
  if (field.envelope != nullptr)
    project_onto(ex, *field.envelope, field.frame, surface.positions.view(), report.envelope);
  return surface;
}

template <exec::Space Exec>
class FieldOn final : public FieldImpl {
 public:
  FieldOn(std::shared_ptr<Exec> ex, FieldData data, Options options, const Vec3d& origin)
      : ex_(std::move(ex)), data_(std::move(data)), options_(std::move(options)), origin_(origin) {
    options_.progress = nullptr;  // it may refer to what the caller no longer has
  }

  [[nodiscard]] double isovalue() const override { return data_.isovalue; }
  [[nodiscard]] double cube_size_world() const override { return data_.frame.size; }
  [[nodiscard]] Vec3d cube_lower_world() const override {
    return {origin_[0] + data_.frame.lower[0], origin_[1] + data_.frame.lower[1], origin_[2] + data_.frame.lower[2]};
  }

  [[nodiscard]] std::vector<float> values(const std::vector<Vec3d>& points_world) const override {
    ex_->activate();
    const Vec3d lower = cube_lower_world();
    std::vector<Vec3f> unit(points_world.size());
    const auto to_unit = [&](const Vec3d& p, std::size_t a) {
      return static_cast<float>(std::clamp((p[a] - lower[a]) / data_.frame.size, 0.0, 1.0));
    };
    std::transform(points_world.begin(), points_world.end(), unit.begin(), [&](const Vec3d& p) {
      return Vec3f{to_unit(p, 0), to_unit(p, 1), to_unit(p, 2)};
    });
    const auto n = static_cast<std::int64_t>(unit.size());
    auto points = exec::make_buffer<Vec3f>(*ex_, n);
    auto out = exec::make_buffer<float>(*ex_, n);
    copy_to_device(*ex_, unit.data(), points.view());
    field::evaluate(*ex_, data_.view(options_.domain_faces), points.cview(), out.view());
    std::vector<float> result(unit.size());
    copy_to_host(*ex_, out.cview(), result.data());
    return result;
  }

  void extract(Mesh& mesh) const override {
    RunReport unused;
    surface::Surface surface = extract_surface(unused);
    std::vector<Attribute> attributes = attributes_at(surface);
    std::vector<Attribute> weakness = weakness_at(surface);
    std::move(weakness.begin(), weakness.end(), std::back_inserter(attributes));
    download(*ex_, std::move(surface), data_.frame, origin_, mesh);
    mesh.attributes = std::move(attributes);
  }

  void extract_and_release(Mesh& mesh, RunReport& report) override {
    PhaseClock clock(*ex_);
    surface::Surface surface = extract_surface(report);
    std::vector<Attribute> weakness = weakness_at(surface);
    data_.values.reset();
    std::vector<Attribute> attributes = attributes_at(surface);
    std::move(weakness.begin(), weakness.end(), std::back_inserter(attributes));
    clock.lap(report.extract_ms);
    const octree::Frame frame = data_.frame;
    data_ = {};
    download(*ex_, std::move(surface), frame, origin_, mesh);
    mesh.attributes = std::move(attributes);
    clock.lap(report.download_ms);
    clock.read();
    report.device_peak_bytes = ex_->pool()->peak_bytes();
  }

 private:
  [[nodiscard]] surface::Surface extract_surface(RunReport& report) const {
    ex_->activate();
    surface::Surface surface = detail::extract(*ex_, data_, options_, report);
    if (surface.triangles.empty() && report.trim.triangles_before > 0)
      throw Error(ErrorCode::empty_result,
                  "all of the surface was trimmed away; choose a smaller trim quantile or island ratio");
    if (surface.triangles.empty())
      throw Error(ErrorCode::empty_result, "the surface has no triangles; are the normals oriented consistently?");
    return surface;
  }

  [[nodiscard]] std::vector<Attribute> attributes_at(const surface::Surface& surface) const {
    std::vector<Attribute> attributes;
    const auto keep = [&](const field::Channel& channel, exec::Buffer<float> values) {
      attributes.push_back({channel.name, channel.type, {}});
      download_array(*ex_, values, attributes.back().values);
    };
    field::interpolate(*ex_, data_.tree, data_.attributes, surface.positions.cview(), keep);
    if (options_.density) attributes.push_back(density_at(surface));
    return attributes;
  }

  /// Samples per unit of area at the vertices.
  [[nodiscard]] Attribute density_at(const surface::Surface& surface) const {
    const std::int64_t n = surface.positions.size();
    auto out = exec::make_buffer<float>(*ex_, n);
    poisson::evaluate_density(*ex_, data_.tree, data_.density, surface.positions.cview(), out.view());
    Attribute density{"density", AttributeType::float32, std::vector<float>(static_cast<std::size_t>(n))};
    copy_to_host(*ex_, out.cview(), density.values.data());
    const double cell = data_.frame.size / static_cast<double>(std::int64_t{1} << data_.tree.depth);
    for (float& value : density.values) value = static_cast<float>(value / (cell * cell));
    return density;
  }

  /// The attribute "weakness", if it is asked for. Needs the field.
  [[nodiscard]] std::vector<Attribute> weakness_at(const surface::Surface& surface) const {
    if (!options_.weakness) return {};
    const std::int64_t n = surface.positions.size();
    auto out = exec::make_buffer<float>(*ex_, n);
    evaluate_weakness(*ex_, data_.tree, data_.density, data_.values.data(), data_.weakness, surface.positions.cview(),
                      out.view());
    Attribute weakness{"weakness", AttributeType::float32, std::vector<float>(static_cast<std::size_t>(n))};
    copy_to_host(*ex_, out.cview(), weakness.values.data());
    return {std::move(weakness)};
  }

  std::shared_ptr<Exec> ex_;
  FieldData data_;
  Options options_;
  Vec3d origin_;
};

template <exec::Space Exec>
std::shared_ptr<FieldImpl> make_field(std::shared_ptr<Exec> ex, FieldData data, const Options& options,
                                      const Vec3d& origin) {
  return std::make_shared<FieldOn<Exec>>(std::move(ex), std::move(data), options, origin);
}

}  // namespace pointskin::detail
