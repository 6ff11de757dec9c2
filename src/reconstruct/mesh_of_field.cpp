#include "reconstruct/mesh_of_field.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "diagnose/look.hpp"
#include "diagnose/verdict.hpp"
#include "exec/host_array.hpp"
#include "exec/this_space.hpp"
#include "field/evaluate.hpp"
#include "poisson/density.hpp"
#include "reconstruct/kept_names.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/pieces_by_support.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/trim_to_samples.hpp"
#include "reconstruct/within_envelope.hpp"
#include "surface/pieces.hpp"
#include "surface/volume.hpp"

namespace pointskin::detail {
namespace {

/// A trim that was to be chosen leaves out what closes the surface on the faces of the cube: that may be near samples.
DomainFaces domain_faces(const FieldData& field, const Options& options) {
  const bool opens =
      options.trim == Options::kAutomaticTrim && diagnose::runs_into_faces(diagnose::findings_of(field.seen));
  return opens ? DomainFaces::open : options.domain_faces;
}

/// Where to cut.
struct TrimRule {
  double share = 0;  ///< 0: nowhere
  float limit = 0;   ///< spacing in finest cells
};

/// As the fit settled it; or now, of a field that keeps all.
template <exec::Space Exec>
TrimRule trim_rule(Exec& ex, const FieldData& field, const Options& options) {
  if (!field.keeps_all) return {field.trim, field.trim_limit};
  const double share = options.trim == Options::kAutomaticTrim ? field.fitting_trim : options.trim;
  if (share <= 0) return {};
  return {share, trim_limit(ex, field.tree, field.density, field.samples.positions.cview(),
                            field.samples.normals.cview(), share)};
}

/// False if the trim was to be chosen, and the surface is near the samples everywhere.
template <exec::Space Exec>
bool is_worth_trimming(Exec& ex, const FieldData& field, const surface::Surface& surface, const Options& options) {
  if (options.trim != Options::kAutomaticTrim) return true;
  const diagnose::Findings findings = diagnose::findings_of(field.seen);
  if (is_cut_by_faces(findings)) return true;
  exec::Buffer<diagnose::Counts> own;  // of this surface, where others may follow
  if (field.keeps_all) {
    own = exec::make_buffer<diagnose::Counts>(ex, field.counts.size());
    copy(ex, field.counts.cview(), own.view());
  }
  const exec::Buffer<diagnose::Counts>& counts = field.keeps_all ? own : field.counts;
  diagnose::look_at_surface(ex, field.tree.view(), diagnose::far_depth(findings, field.tree.depth), surface, counts);
  return diagnose::findings_of(diagnose::read_counts(ex, counts)).far >= kLittleFar;
}

/// Samples per area of the cube's unit at the vertices.
template <exec::Space Exec>
exec::Buffer<float> density_at_vertices(Exec& ex, const FieldData& field, const surface::Surface& surface) {
  auto density = exec::make_buffer<float>(ex, surface.positions.size());
  poisson::evaluate_density(ex, field.tree, field.density, surface.positions.cview(), density.view());
  for_each(ex, "pieces.density", density.size(),
           poisson::PerArea{std::ldexp(1.0, -2 * field.tree.depth), density.view()});
  return density;
}

/// The surface without small pieces, where some are to go.
template <exec::Space Exec>
surface::Surface without_pieces(Exec& ex, surface::Surface surface, std::int64_t lone_corners, const FieldData& field,
                                const Options& options, RunReport& report) {
  surface::PieceOptions pieces{options.largest, options.min_component};
  exec::Buffer<float> density;
  if (picks_pieces_by_support(field, options)) pieces.least_samples = fewest_samples(field, lone_corners);
  if (pieces.least_samples > 0) {
    density = density_at_vertices(ex, field, surface);
    pieces.density = density.cview();
  } else if (!options.largest && options.min_component == 0) {
    return surface;
  }
  surface::PieceCounts counts;
  surface = surface::keep_pieces(ex, std::move(surface), pieces, counts);
  report.pieces = {counts.pieces, counts.pieces_removed, counts.triangles_removed};
  return surface;
}

/// Of a closed surface whose vertices were moved onto an envelope: one narrower than the cells presses it flat. Of a
/// surface whose pieces were chosen, a cavity may be what is left.
template <exec::Space Exec>
void check_volume(Exec& ex, int depth, const surface::Surface& surface) {
  if (surface.triangles.empty() || surface::sign_of_volume(ex, depth, surface) != 0) return;
  throw Error(ErrorCode::empty_result,
              "the surface encloses nothing within the envelope, which is narrower there than the octree's cells; "
              "choose a larger depth, or an envelope of the points' size");
}

}  // namespace

template <exec::Space Exec>
surface::Surface extract(Exec& ex, const FieldData& field, const Options& options, RunReport& report) {
  const TrimRule rule = trim_rule(ex, field, options);
  const bool trim = rule.share > 0;  // which needs normals
  surface::ExtractOptions extraction{options.linear_fit ? 0 : kCurvature, options.normals || trim};
  if (field.envelope != nullptr) extraction.move_vertices = clip_to(ex, *field.envelope, field.frame, report.envelope);
  const DomainFaces faces = domain_faces(field, options);
  surface::Surface surface =
      surface::extract_surface(ex, field.view(faces, options.isovalue.value_or(field.isovalue)), extraction);
  const std::int64_t lone_corners = surface.lone_corners;
  if (trim && is_worth_trimming(ex, field, surface, options)) {
    surface::TrimCounts counts;
    surface =
        trim_to_samples(ex, field.tree, field.density, std::move(surface), {rule.limit, options.island_ratio}, counts);
    report.trim = trim_report(counts, field.frame, field.tree.depth, rule.limit);
    report.trim.quantile = rule.share;
  }
  if (!options.normals) surface.normals.reset();
  surface = without_pieces(ex, std::move(surface), lone_corners, field, options, report);
  if (field.envelope != nullptr) {
    project_onto(ex, *field.envelope, field.frame, surface.positions.view(), report.envelope);
    const bool closed = faces == DomainFaces::closed && report.trim.triangles_before == 0;
    if (closed && report.envelope.vertices_moved > 0) check_volume(ex, field.tree.depth, surface);
  }
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
  check_triangles(surface.triangles.size(), report);
  return surface;
}

namespace {

/// An array of floats as values of an attribute.
template <exec::Space Exec>
exec::TypedBuffer floats(Exec& ex, std::int64_t n) {
  return exec::make_typed_buffer(ex, AttributeType::float32, n);
}

/// Samples per unit of area at the vertices.
template <exec::Space Exec>
exec::TypedBuffer density_at(Exec& ex, const FieldData& field, const surface::Surface& surface) {
  exec::TypedBuffer out = floats(ex, surface.positions.size());
  poisson::evaluate_density(ex, field.tree, field.density, surface.positions.cview(), out.as<float>());
  const double cell = field.frame.size / static_cast<double>(std::int64_t{1} << field.tree.depth);
  for_each(ex, "density.area", out.size, poisson::PerArea{cell * cell, out.as<float>()});
  return out;
}

/// The attribute "weakness". Needs the field's values.
template <exec::Space Exec>
exec::TypedBuffer weakness_at(Exec& ex, const FieldData& field, const surface::Surface& surface) {
  const WeaknessScale scale = field.keeps_all ? weakness_scale(ex, field.tree, field.density, field.values.data(),
                                                               field.samples.positions.cview())
                                              : field.weakness;
  exec::TypedBuffer out = floats(ex, surface.positions.size());
  evaluate_weakness(ex, field.tree, field.density, field.values.data(), scale, surface.positions.cview(),
                    out.as<float>());
  return out;
}

/// The weakness at a surface on the host, while the field's values are there still; or none.
template <exec::Space Exec>
std::vector<Attribute> early_attributes(Exec& ex, const FieldData& field, const Options& options,
                                        const surface::Surface& surface) {
  if (!options.weakness) return {};
  return {{"weakness", exec::download_typed(ex, weakness_at(ex, field, surface))}};
}

/// Attributes of the samples at a surface, under their names on the mesh, one after another.
/// @param keep  keep(place, name, values)
template <exec::Space Exec, class Keep>
void sample_attributes(Exec& ex, const FieldData& field, const Options& options, const surface::Surface& surface,
                       const Keep& keep) {
  if (!options.attributes) return;
  const std::vector<std::string> names = kept_names(field.attributes.names, options.density, options.weakness);
  const auto take = [&](std::size_t place, exec::TypedBuffer values) { keep(place, names[place], std::move(values)); };
  field::AttributeSamples const& samples = field.attributes;
  field::interpolate(ex, field.tree, samples, surface.positions.cview(), take);
  field::find_labels(ex, field.tree, samples, surface.positions.cview(), take);
}

/// Attributes of the samples, density, and last `others`.
template <exec::Space Exec>
std::vector<Attribute> attributes_at(Exec& ex, const FieldData& field, const Options& options,
                                     const surface::Surface& surface, std::vector<Attribute> others) {
  std::vector<Attribute> attributes(options.attributes ? field.attributes.names.size() : 0);
  sample_attributes(ex, field, options, surface,
                    [&](std::size_t place, const std::string& name, exec::TypedBuffer values) {
                      attributes[place] = {name, exec::download_typed(ex, std::move(values))};
                    });
  if (options.density) attributes.push_back({"density", exec::download_typed(ex, density_at(ex, field, surface))});
  std::move(others.begin(), others.end(), std::back_inserter(attributes));
  return attributes;
}

}  // namespace

template <exec::Space Exec>
void download_mesh(Exec& ex, const FieldData& field, surface::Surface surface, const Options& options,
                   const Vec3d& origin, Mesh& mesh) {
  std::vector<Attribute> attributes =
      attributes_at(ex, field, options, surface, early_attributes(ex, field, options, surface));
  download(ex, std::move(surface), field.frame, origin, mesh);
  mesh.attributes = std::move(attributes);
}

template <exec::Space Exec>
void extract_and_release(Exec& ex, FieldData& field, const Options& options, const Vec3d& origin, Mesh& mesh,
                         RunReport& report) {
  PhaseClock clock(ex);
  surface::Surface surface = extract_some(ex, field, options, report);
  look_at_surface(ex, surface, field);
  std::vector<Attribute> weakness = early_attributes(ex, field, options, surface);
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
MeshBuffers mesh_in_space(Exec& ex, const FieldData& field, surface::Surface surface, const Options& options) {
  MeshBuffers mesh;
  const auto add = [&](const std::string& name, exec::TypedBuffer values) {
    mesh.names.push_back(name);
    mesh.attributes.push_back(std::move(values));
  };
  if (options.attributes) {
    mesh.names.resize(field.attributes.names.size());
    mesh.attributes.resize(field.attributes.names.size());
  }
  sample_attributes(ex, field, options, surface,
                    [&](std::size_t place, const std::string& name, exec::TypedBuffer values) {
                      mesh.names[place] = name;
                      mesh.attributes[place] = std::move(values);
                    });
  if (options.density) add("density", density_at(ex, field, surface));
  if (options.weakness) add("weakness", weakness_at(ex, field, surface));
  to_world(ex, field.frame, surface.positions.view());
  mesh.surface = std::move(surface);
  return mesh;
}

template <exec::Space Exec>
Mesh download_mesh_of(Exec& ex, const DeviceMesh& mesh) {
  Mesh out;
  out.origin = mesh.origin;
  const auto fetch = [&](const auto& from, auto& to) {
    exec::resize_to_overwrite(to, static_cast<std::size_t>(from.size));
    copy_to_host(ex, ArrayView<const std::remove_pointer_t<decltype(from.data)>>{from.data, from.size}, to.data());
  };
  fetch(mesh.vertices, out.vertices);
  fetch(mesh.normals, out.normals);
  fetch(mesh.triangles, out.triangles);
  for (const DeviceAttribute& from : mesh.attributes)
    out.attributes.push_back({from.name, exec::download_typed(ex, borrowed(from, mesh.vertices.size))});
  return out;
}

template <exec::Space Exec>
std::vector<float> values_at(Exec& ex, const FieldData& field, const Vec3d& origin, std::span<const Vec3d> points) {
  const octree::Frame& cube = field.frame;
  const Vec3d lower = origin + cube.lower;
  std::vector<Vec3f> unit(points.size());
  const auto to_unit = [&](const Vec3d& p, std::size_t a) {
    return static_cast<float>(std::clamp((p[a] - lower[a]) / cube.size, 0.0, 1.0));
  };
  std::transform(points.begin(), points.end(), unit.begin(), [&](const Vec3d& p) {
    return Vec3f{to_unit(p, 0), to_unit(p, 1), to_unit(p, 2)};
  });
  const auto n = static_cast<std::int64_t>(unit.size());
  auto queries = exec::make_buffer<Vec3f>(ex, n);
  auto out = exec::make_buffer<float>(ex, n);
  copy_to_device(ex, unit.data(), queries.view());
  field::evaluate(ex, field.view(DomainFaces::closed), queries.cview(), out.view());
  std::vector<float> result(unit.size());
  copy_to_host(ex, out.cview(), result.data());
  return result;
}

PSK_INSTANTIATE(extract);
PSK_INSTANTIATE(look_at_surface);
PSK_INSTANTIATE(extract_some);
PSK_INSTANTIATE(download_mesh);
PSK_INSTANTIATE(extract_and_release);
PSK_INSTANTIATE(mesh_in_space);
PSK_INSTANTIATE(download_mesh_of);
PSK_INSTANTIATE(values_at);

}  // namespace pointskin::detail
