#include "reconstruct/fit_field.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "diagnose/look.hpp"
#include "diagnose/verdict.hpp"
#include "exec/this_space.hpp"
#include "field/distance.hpp"
#include "field/evaluate.hpp"
#include "poisson/boundary.hpp"
#include "poisson/divergence.hpp"
#include "poisson/screening.hpp"
#include "poisson/solve.hpp"
#include "poisson/trust.hpp"
#include "reconstruct/fit_cube.hpp"
#include "reconstruct/offset_surface.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/trim_to_samples.hpp"
#include "reconstruct/within_envelope.hpp"
#include "surface/pieces.hpp"

namespace pointskin::detail {
namespace {

/// Tells the caller where the run is. @throws Error interrupted if it wants to stop
void announce(const Options& options, const char* phase, double fraction) {
  if (options.progress && !options.progress({phase, fraction}))
    throw Error(ErrorCode::interrupted, std::string("cancelled before the phase \"") + phase + "\"");
}

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
  const bool chooses = options.trim == Options::kAutomaticTrim;
  if (setup.look || chooses) {
    field.counts = diagnose::make_counts(ex);
    diagnose::look_at_samples(ex, field.tree.view(), field.density, samples.view(), field.counts);
  }
  field.trim =
      chooses ? diagnose::fitting_trim(diagnose::findings_of(diagnose::read_counts(ex, field.counts))) : options.trim;
  if (field.trim > 0) field.trim_limit = trim_limit(ex, field.tree, field.density, samples, field.trim);
}

/// Looks at the solved field, and reads all that was counted.
template <exec::Space Exec>
void look_at_fit(Exec& ex, const poisson::Samples& samples, const Options& options, FieldData& field) {
  diagnose::look_at_field(ex, field.view(options.domain_faces), samples.view(), field.counts);
  field.seen = diagnose::read_counts(ex, field.counts);
}

/// The report of a field that nothing was solved for.
void report_octree(const octree::OctreeData& tree, RunReport& report) {
  std::vector<poisson::LevelSolve> levels(static_cast<std::size_t>(tree.depth) + 1);
  for (int d = 0; d <= tree.depth; ++d) levels[static_cast<std::size_t>(d)].depth = d;
  report_levels(tree, levels, report);
}

/// Samples to signed distance (P10), once frame, tree and channels of `field` are there.
template <exec::Space Exec>
void fit_distance(Exec& ex, SortedSamples& sorted, const FitSetup& setup, const Options& options, FieldData& field,
                  RunReport& report) {
  PhaseClock clock(ex);
  poisson::Samples& samples = sorted.samples;
  const bool has_attributes = !field.attributes.names.empty();
  announce(options, "splat", 0.25);
  exec::Buffer<float> weights;
  if (options.confidence) weights = poisson::confidence_weights(ex, samples.normals.cview());
  field::normalise(ex, samples.normals.view());
  if (options.density || options.trim != 0)
    field.density = poisson::splat_density(ex, field.tree, samples.positions.cview());
  look_at_samples(ex, samples, setup, options, field);
  clock.lap(report.splat_ms);

  announce(options, "solve", 0.45);
  field.values =
      field::distance_to_planes(ex, field.tree, {samples.positions.cview(), samples.normals.cview(), weights.cview()});
  field.isovalue = 0;
  if (!field.counts.empty()) look_at_fit(ex, samples, options, field);
  if (setup.keep_samples) {
    field.samples.normals = std::move(samples.normals);
    keep_samples(ex, samples, std::move(sorted.added), field.samples);
  }
  if (has_attributes) {
    field.attributes.weights = std::move(weights);
    field.attributes.positions = std::move(samples.positions);
  }
  clock.lap(report.solve_ms);
  clock.read();
  report.isovalue = 0;
  report_octree(field.tree, report);
}

/// Samples to the screened Poisson field (P4 to P8), once frame, tree and channels of `field` are there.
template <exec::Space Exec>
void fit_poisson(Exec& ex, SortedSamples& sorted, const FitSetup& setup, const Options& options, FieldData& field,
                 RunReport& report) {
  PhaseClock clock(ex);
  poisson::Samples& samples = sorted.samples;
  const bool has_attributes = !field.attributes.names.empty();
  announce(options, "splat", 0.25);
  if (has_attributes && options.confidence)
    field.attributes.weights = poisson::confidence_weights(ex, samples.normals.cview());
  field.density = poisson::splat_density(ex, field.tree, samples.positions.cview());
  poisson::weigh_samples(ex, field.tree, field.density, {options.samples_per_node, options.confidence}, samples);
  field.resolution = poisson::find_resolution(ex, field.tree, samples);
  look_at_samples(ex, samples, setup, options, field);
  if (!options.density && !options.weakness && options.trim == 0) field.density.counts.reset();
  if (options.screening > 0 && !options.fixed_screening) poisson::weigh_trust(ex, field.tree, samples);
  exec::Buffer<float> divergence = poisson::splat_divergence(ex, field.tree, samples.view(), field.resolution);
  if (setup.keep_samples) field.samples.normals = std::move(samples.normals);
  samples.normals.reset();
  poisson::Screening screening;
  if (options.screening > 0) screening = poisson::collapse_samples(ex, field.tree, samples.view());
  samples.trust.reset();
  clock.lap(report.splat_ms);

  poisson::SolveOptions solving{options.screening, options.iterations, options.residuals};
  solving.before_level = [&](int depth) {  // every level costs about four times the one before
    announce(options, "solve", 0.45 + 0.35 * std::pow(4.0, depth - options.depth - 1));
  };
  const octree::OctreeView tree = field.resolution.view(field.tree);
  exec::Buffer<std::uint8_t> free_unknowns = find_free_unknowns(ex, tree, field, options);
  solving.free_unknowns = free_unknowns.cview();
  exec::Buffer<std::int32_t> matches;
  if (setup.before != nullptr && may_start_from(*setup.before, field)) {
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
  if (!field.counts.empty()) look_at_fit(ex, samples, options, field);
  if (setup.keep_samples) keep_samples(ex, samples, std::move(sorted.added), field.samples);
  if (options.weakness)
    field.weakness = weakness_scale(ex, field.tree, field.density, field.values.data(), samples.positions.cview());
  if (has_attributes) field.attributes.positions = std::move(samples.positions);
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
  announce(options, "octree", 0.05);
  field.frame = setup.cube ? *setup.cube : fit_cube(ex, points, options, report);
  report.points = points.used_count();
  SortedSamples sorted = sort_into_cube(ex, points, field.frame);
  field.attributes = std::move(sorted.attributes);
  if (!setup.keep_points) points = {};
  field.tree = octree::build_octree(ex, sorted.keys.cview(), options.depth);
  sorted.keys.reset();
  clock.lap(report.octree_ms);
  if (options.field == FieldKind::distance)
    fit_distance(ex, sorted, setup, options, field, report);
  else
    fit_poisson(ex, sorted, setup, options, field, report);
  clock.read();
  return field;
}

}  // namespace

template <exec::Space Exec>
FieldData fit_field(Exec& ex, PointBuffers& points, const FitSetup& setup, const Options& options, RunReport& report) {
  FieldData field = fit_to_points(ex, points, setup, options, report);
  if (options.offset == 0) return field;
  announce(options, "solve", 0.8);
  FieldData offset = offset_surface(ex, field, options, report);
  offset.seen = field.seen;
  return offset;
}

/// Share of curvature that a crossing takes (surface/edge_vertex.hpp). The screening pulls the trilinear function to
/// the samples, whose own crossing is linear; the smooth function that it stands for is curved. Halfway is nearest to
/// the surface (docs/decisions/0017-noise-and-smoothness.md).
constexpr float kCurvature = 0.5F;

namespace {

/// A trim that was to be chosen leaves out what closes the surface on the faces of the cube: that may be near samples.
DomainFaces domain_faces(const FieldData& field, const Options& options) {
  const bool opens =
      options.trim == Options::kAutomaticTrim && diagnose::runs_into_faces(diagnose::findings_of(field.seen));
  return opens ? DomainFaces::open : options.domain_faces;
}

/// False if the trim was to be chosen, and the surface is near the samples everywhere.
template <exec::Space Exec>
bool is_worth_trimming(Exec& ex, const FieldData& field, const surface::Surface& surface, const Options& options) {
  constexpr double kLittle = 0.005;  // of the area
  if (options.trim != Options::kAutomaticTrim) return true;
  const diagnose::Findings findings = diagnose::findings_of(field.seen);
  if (diagnose::runs_into_faces(findings) && findings.faces_inside < 1) return true;
  diagnose::look_at_surface(ex, field.tree.view(), diagnose::far_depth(findings, field.tree.depth), surface,
                            field.counts);
  return diagnose::findings_of(diagnose::read_counts(ex, field.counts)).far >= kLittle;
}

/// The surface without small pieces, where some are to go.
template <exec::Space Exec>
surface::Surface without_pieces(Exec& ex, surface::Surface surface, const Options& options, RunReport& report) {
  if (!options.largest && options.min_component == 0) return surface;
  surface::PieceCounts counts;
  surface = surface::keep_pieces(ex, std::move(surface), {options.largest, options.min_component}, counts);
  report.pieces = {counts.pieces, counts.pieces_removed, counts.triangles_removed};
  return surface;
}

}  // namespace

template <exec::Space Exec>
surface::Surface extract(Exec& ex, const FieldData& field, const Options& options, RunReport& report) {
  const bool trim = field.trim > 0;  // which needs normals
  surface::ExtractOptions extraction{options.linear_fit ? 0 : kCurvature, options.normals || trim};
  if (field.envelope != nullptr) extraction.move_vertices = clip_to(ex, *field.envelope, field.frame, report.envelope);
  surface::Surface surface = surface::extract_surface(ex, field.view(domain_faces(field, options)), extraction);
  if (trim && is_worth_trimming(ex, field, surface, options)) {
    surface::TrimCounts counts;
    surface = trim_to_samples(ex, field.tree, field.density, std::move(surface),
                              {field.trim_limit, options.island_ratio}, counts);
    report.trim = trim_report(counts, field.frame, field.tree.depth, field.trim_limit);
    report.trim.quantile = field.trim;
  }
  if (!options.normals) surface.normals.reset();
  surface = without_pieces(ex, std::move(surface), options, report);
  if (field.envelope != nullptr)
    project_onto(ex, *field.envelope, field.frame, surface.positions.view(), report.envelope);
  return surface;
}

template <exec::Space Exec>
void look_at_surface(Exec& ex, const surface::Surface& surface, FieldData& field) {
  if (field.counts.empty()) return;
  const int far_depth = diagnose::far_depth(diagnose::findings_of(field.seen), field.tree.depth);
  diagnose::look_at_surface(ex, field.tree.view(), far_depth, surface, field.counts);
  field.seen = diagnose::read_counts(ex, field.counts);
}

template <exec::Space Exec>
surface::Surface extract_some(Exec& ex, const FieldData& field, const Options& options, RunReport& report) {
  ex.activate();
  surface::Surface surface = detail::extract(ex, field, options, report);
  if (surface.triangles.empty() && report.pieces.pieces > 0)
    throw Error(ErrorCode::empty_result, "all pieces of the surface are smaller than min-component");
  if (surface.triangles.empty() && report.trim.triangles_before > 0)
    throw Error(ErrorCode::empty_result,
                "all of the surface was trimmed away; choose a smaller trim quantile or island ratio");
  if (surface.triangles.empty())
    throw Error(ErrorCode::empty_result, "the surface has no triangles; are the normals oriented consistently?");
  return surface;
}

namespace {

/// Samples per unit of area at the vertices.
template <exec::Space Exec>
Attribute density_at(Exec& ex, const FieldData& field, const surface::Surface& surface) {
  const std::int64_t n = surface.positions.size();
  auto out = exec::make_buffer<float>(ex, n);
  poisson::evaluate_density(ex, field.tree, field.density, surface.positions.cview(), out.view());
  std::vector<float> density(static_cast<std::size_t>(n));
  copy_to_host(ex, out.cview(), density.data());
  const double cell = field.frame.size / static_cast<double>(std::int64_t{1} << field.tree.depth);
  for (float& value : density) value = static_cast<float>(value / (cell * cell));
  return {"density", std::move(density)};
}

/// The attribute "weakness", if it is asked for. Needs the field's values.
template <exec::Space Exec>
std::vector<Attribute> weakness_at(Exec& ex, const FieldData& field, const Options& options,
                                   const surface::Surface& surface) {
  if (!options.weakness) return {};
  const std::int64_t n = surface.positions.size();
  auto out = exec::make_buffer<float>(ex, n);
  evaluate_weakness(ex, field.tree, field.density, field.values.data(), field.weakness, surface.positions.cview(),
                    out.view());
  std::vector<float> weakness(static_cast<std::size_t>(n));
  copy_to_host(ex, out.cview(), weakness.data());
  return {{"weakness", std::move(weakness)}};
}

/// Attributes of the samples, density, and last `others`.
template <exec::Space Exec>
std::vector<Attribute> attributes_at(Exec& ex, const FieldData& field, const Options& options,
                                     const surface::Surface& surface, std::vector<Attribute> others) {
  std::vector<Attribute> attributes;
  for (const std::string& name : field.attributes.names) attributes.push_back({name, {}});
  const auto keep = [&](std::size_t place, exec::TypedBuffer values) {
    attributes[place].values = exec::download_typed(ex, std::move(values));
  };
  field::interpolate(ex, field.tree, field.attributes, surface.positions.cview(), keep);
  field::find_labels(ex, field.tree, field.attributes, surface.positions.cview(), keep);
  if (options.density) attributes.push_back(density_at(ex, field, surface));
  std::move(others.begin(), others.end(), std::back_inserter(attributes));
  return attributes;
}

}  // namespace

template <exec::Space Exec>
void download_mesh(Exec& ex, const FieldData& field, surface::Surface surface, const Options& options,
                   const Vec3d& origin, Mesh& mesh) {
  std::vector<Attribute> attributes =
      attributes_at(ex, field, options, surface, weakness_at(ex, field, options, surface));
  download(ex, std::move(surface), field.frame, origin, mesh);
  mesh.attributes = std::move(attributes);
}

template <exec::Space Exec>
void extract_and_release(Exec& ex, FieldData& field, const Options& options, const Vec3d& origin, Mesh& mesh,
                         RunReport& report) {
  PhaseClock clock(ex);
  surface::Surface surface = extract_some(ex, field, options, report);
  look_at_surface(ex, surface, field);
  std::vector<Attribute> weakness = weakness_at(ex, field, options, surface);
  field.values.reset();
  std::vector<Attribute> attributes = attributes_at(ex, field, options, surface, std::move(weakness));
  clock.lap(report.extract_ms);
  const octree::Frame frame = field.frame;
  const diagnose::Counts seen = field.seen;
  field = {};
  field.seen = seen;
  download(ex, std::move(surface), frame, origin, mesh);
  mesh.attributes = std::move(attributes);
  clock.lap(report.download_ms);
  clock.read();
  report.device_peak_bytes = ex.pool()->peak_bytes();
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
    download_mesh(*ex_, data_, extract_some(*ex_, data_, options_, unused), options_, origin_, mesh);
  }

  [[nodiscard]] const diagnose::Counts& seen() const override { return data_.seen; }

  void extract_and_release(Mesh& mesh, RunReport& report) override {
    detail::extract_and_release(*ex_, data_, options_, origin_, mesh, report);
  }

 private:
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

PSK_INSTANTIATE(fit_field);
PSK_INSTANTIATE(extract);
PSK_INSTANTIATE(look_at_surface);
PSK_INSTANTIATE(extract_some);
PSK_INSTANTIATE(download_mesh);
PSK_INSTANTIATE(extract_and_release);
PSK_INSTANTIATE(make_field);

}  // namespace pointskin::detail
