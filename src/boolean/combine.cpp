#include "boolean/combine.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "boolean/crease.hpp"
#include "boolean/keep_apart.hpp"
#include "boolean/set_operation.hpp"
#include "core/announce.hpp"
#include "diagnose/warnings.hpp"
#include "exec/this_space.hpp"
#include "field/surface_distance.hpp"
#include "mesh/oriented_samples.hpp"
#include "octree/frame.hpp"
#include "octree/strays.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/mesh_of_field.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::boolean {
namespace {

using detail::FieldData;
using detail::PhaseClock;
using detail::PointBuffers;

/// Samples of a mesh along a finest cell: what a cell needs to be resolved (Options::samples_per_node), twice over.
constexpr double kMeshSamplesPerCell = 2;

/// Moves points to coordinates relative to another origin.
struct Rebase {
  Vec3d move;
  ArrayView<Vec3f> positions;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    positions[i] = {static_cast<float>(static_cast<double>(p.x) + move[0]),
                    static_cast<float>(static_cast<double>(p.y) + move[1]),
                    static_cast<float>(static_cast<double>(p.z) + move[2])};
  }
};

/// Samples from the unit cube to the cloud's coordinates.
struct AddSample {
  octree::Frame frame;
  ArrayView<const Vec3f> unit;
  ArrayView<Vec3f> world;
  PSK_HD void operator()(std::int64_t i) const { world[i] = frame.to_world(unit[i]); }
};

/// Whose progress counts as the part [from, from + share) of the whole.
Options part_of_run(const Options& options, double from, double share) {
  Options part = options;
  if (options.progress)
    part.progress = [report = options.progress, from, share](const Progress& progress) {
      return report({progress.phase, from + share * progress.fraction});
    };
  return part;
}

void join(const Vec3f& p, Bounds& box) {
  box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
  box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
}
Bounds joined(Bounds a, const Bounds& b) {
  join(b.lower, a);
  join(b.upper, a);
  return a;
}

/// Runs `f`, whose errors then tell what was being done.
template <class F>
void saying(const char* what, const F& f) {
  try {
    f();
  } catch (const Error& error) {
    throw error.while_doing(what);
  }
}

const char* name_of(BooleanOp op) {
  switch (op) {
    case BooleanOp::unite:
      return "union";
    case BooleanOp::intersect:
      return "intersection";
    case BooleanOp::subtract:
      return "difference";
    case BooleanOp::symmetric_difference:
      break;
  }
  return "symmetric difference";
}

template <exec::Space Exec>
class Combination {
 public:
  /// @param origin  that of A: what places of the run are relative to
  Combination(Exec& ex, const Vec3d& origin) : ex_(ex), origin_(origin) {}

  BooleanResult run(const BooleanOperand& a, const BooleanOperand& b, BooleanOp op, const BooleanOptions& options) {
    ex_.pool()->reset_peak();
    BooleanResult result;
    BooleanReport& report = result.report;
    Solid first, second;
    fit_both(a, b, options.reconstruction, first, second, report);

    PhaseClock clock(ex_);
    find_places(first, second, options);
    report_fates(first, op, true, report.a);
    report_fates(second, op, false, report.b);
    if (report.a.kept + report.b.kept == 0)
      throw Error(ErrorCode::empty_result,
                  std::string("the ") + name_of(op) + " is empty: no point of either lies on its surface");
    clock.lap(report.classify_ms);
    const double steepness = find_samples(first, second, op, options, report);
    clock.lap(report.crease_ms);
    PointBuffers kept = gather(first, second, op, report);
    clock.lap(report.gather_ms);
    clock.read();
    release(first, steepness > 0);
    release(second, steepness > 0);
    download_cloud(kept, result.cloud);

    const Options part = part_of_run(options.reconstruction, 0.6, 0.4);
    FieldData field = fit_field(ex_, kept, {.cube = frame_, .drop_specks = true}, part, report.result);
    if (steepness > 0)
      keep_apart(first.field, second.field, steepness, options.reconstruction.domain_faces, field, report);
    first = {};
    second = {};
    announce(part.progress, "extract", 0.8);
    extract_and_release(ex_, field, options.reconstruction, origin_, result.mesh, report.result);
    diagnose::warn_of_origin(origin_, octree::float_step(frame_), "cells are", cell_at(options.reconstruction.depth),
                             report.result.warnings);
    report.device_peak_bytes = ex_.pool()->peak_bytes();
    return result;
  }

 private:
  /// One of the two, on the device.
  struct Solid {
    PointBuffers points;
    Bounds box;
    octree::StrayPoints strays;
    FieldData field;
    exec::Buffer<Place> places;  // of the points that are used
  };

  void fit_both(const BooleanOperand& a, const BooleanOperand& b, const Options& given, Solid& first, Solid& second,
                BooleanReport& report) {
    Options options = given;
    options.trim = 0;
    options.density = false;
    saying("taking A", [&] { take(a, options, first); });
    saying("taking B", [&] { take(b, options, second); });
    frame_ = octree::frame_around(joined(first.box, second.box), options.scale);
    if (a.mesh() != nullptr) sample(*a.mesh(), options, first);
    if (b.mesh() != nullptr) sample(*b.mesh(), options, second);
    saying("reconstructing A", [&] { fit(part_of_run(options, 0, 0.3), first, report.a); });
    saying("reconstructing B", [&] { fit(part_of_run(options, 0.3, 0.3), second, report.b); });
  }

  void take(const BooleanOperand& operand, const Options& options, Solid& solid) {
    if (operand.mesh() != nullptr)
      solid.box = box_of(*operand.mesh());
    else
      take_cloud(*operand.cloud(), options, solid);
  }

  void take_cloud(const Cloud& cloud, const Options& options, Solid& solid) {
    solid.points = detail::upload(ex_, cloud);
    rebase(cloud.origin, solid.points);
    solid.strays = octree::find_strays(ex_, solid.points.positions.cview());
    solid.box = solid.strays.core;
    if (!options.keep_strays) return leave_out(ex_, solid.strays, solid.points);
    for (const Vec3f& p : solid.strays.positions) join(p, solid.box);
    solid.strays = {};
  }

  Bounds box_of(const Mesh& mesh) const {
    Bounds box = mesh_detail::bounds_of_solid(mesh, ex_.host_threads());
    for (Vec3f* corner : {&box.lower, &box.upper}) Rebase{move_from(mesh.origin), {corner, 1}}(0);
    return box;
  }

  void sample(const Mesh& mesh, const Options& options, Solid& solid) {
    const double spacing = cell_at(options.depth) / kMeshSamplesPerCell;
    const Cloud cloud = mesh_detail::sample_surface(mesh, spacing, ex_.host_threads());
    solid.points = detail::upload(ex_, cloud);
    rebase(cloud.origin, solid.points);
  }

  void fit(const Options& options, Solid& solid, BooleanPart& part) {
    solid.field = fit_field(ex_, solid.points, {.keep_points = true, .cube = frame_}, options, part.fit);
    part.points = solid.points.used_count();
    part.strays = solid.strays.size();
    part.fit.strays = part.strays;
  }

  void find_places(Solid& first, Solid& second, const BooleanOptions& options) {
    find_places_of(first, second.field, options);
    find_places_of(second, first.field, options);
  }
  void find_places_of(Solid& solid, const FieldData& other, const BooleanOptions& options) {
    const std::int64_t n = solid.points.used_count();
    const DomainFaces faces = options.reconstruction.domain_faces;
    auto unit = exec::make_buffer<Vec3f>(ex_, n);
    for_each(ex_, "boolean.unit", n,
             octree::ToUnit{frame_, solid.points.positions.cview(), unit.view(), {solid.points.used.cview()}});
    auto to_own = exec::make_buffer<field::SurfaceDistance>(ex_, n);
    auto to_other = exec::make_buffer<field::SurfaceDistance>(ex_, n);
    field::measure_distances(ex_, solid.field.view(faces), unit.cview(), to_own.view());
    field::measure_distances(ex_, other.view(faces), unit.cview(), to_other.view());
    solid.places = exec::make_buffer<Place>(ex_, n);
    boolean::find_places(ex_, to_own.cview(), to_other.cview(), static_cast<float>(options.coincidence_cells),
                         solid.places.view());
  }

  void report_fates(const Solid& solid, BooleanOp op, bool is_first, BooleanPart& part) {
    const FateCounts counts = count_fates(ex_, solid.places.cview(), op, is_first);
    part.kept = counts.kept;
    part.flipped = counts.flipped;
    part.dropped = part.points - counts.kept;
    part.coincident = counts.coincident;
  }

  /// Samples along the curve in which the surfaces cross. @returns the fields' steepness there if the
  /// halves of the result must be kept apart, else 0
  double find_samples(const Solid& first, const Solid& second, BooleanOp op, const BooleanOptions& options,
                      BooleanReport& report) {
    added_ = {};
    if (options.creases == Creases::none) return 0;
    const DomainFaces faces = options.reconstruction.domain_faces;
    const field::FieldView a = first.field.view(faces);
    const field::FieldView b = second.field.view(faces);
    const Crease crease = find_crease(ex_, a, b);
    report.curve_length = crease.length_unit * frame_.size;
    if (crease.size() == 0) return 0;
    added_ = sample_sheets(ex_, a, b, crease, op);
    report.added = added_.positions.size();
    return op == BooleanOp::symmetric_difference ? steepness_at(ex_, crease) : 0;
  }

  /// What is kept of A, what is kept of B, and what was added; takes these over.
  PointBuffers gather(const Solid& first, const Solid& second, BooleanOp op, const BooleanReport& report) {
    const std::int64_t a = report.a.kept;
    const std::int64_t b = report.b.kept;
    const std::int64_t c = report.added;
    PointBuffers kept;
    kept.positions = exec::make_buffer<Vec3f>(ex_, a + b + c);
    kept.normals = exec::make_buffer<Vec3f>(ex_, a + b + c);
    const ArrayView<Vec3f> positions = kept.positions.view();
    const ArrayView<Vec3f> normals = kept.normals.view();
    gather_part(first, op, true, positions.part(0, a), normals.part(0, a));
    gather_part(second, op, false, positions.part(a, b), normals.part(a, b));
    if (c == 0) return kept;
    for_each(ex_, "boolean.world", c, AddSample{frame_, added_.positions.cview(), positions.part(a + b, c)});
    copy(ex_, added_.normals.cview(), normals.part(a + b, c));
    kept.added = exec::make_buffer<std::uint8_t>(ex_, a + b + c);
    exec::fill(ex_, kept.added.view().part(0, a + b), std::uint8_t{0});
    exec::fill(ex_, kept.added.view().part(a + b, c), std::uint8_t{1});
    added_ = {};
    return kept;
  }
  void gather_part(const Solid& solid, BooleanOp op, bool is_first, ArrayView<Vec3f> positions,
                   ArrayView<Vec3f> normals) {
    const PointBuffers& points = solid.points;
    gather_kept(ex_, {points.positions.cview(), points.normals.cview(), points.used.cview()}, solid.places.cview(), op,
                is_first, positions, normals);
  }

  void download_cloud(const PointBuffers& points, Cloud& cloud) {
    cloud.origin = origin_;
    cloud.positions.resize(static_cast<std::size_t>(points.positions.size()));
    cloud.normals.resize(cloud.positions.size());
    copy_to_host(ex_, points.positions.cview(), cloud.positions.data());
    copy_to_host(ex_, points.normals.cview(), cloud.normals.data());
  }

  /// Frees what is not needed any more.
  static void release(Solid& solid, bool keep_field) {
    solid.points = {};
    solid.places.reset();
    if (!keep_field) solid.field = {};
  }

  void keep_apart(const FieldData& a, const FieldData& b, double steepness, DomainFaces faces, FieldData& field,
                  BooleanReport& report) {
    PhaseClock clock(ex_);
    boolean::keep_apart(ex_, a.view(faces), b.view(faces), steepness, field.resolution.view(field.tree),
                        field.values.view());
    clock.lap(report.apart_ms);
    clock.read();
  }

  [[nodiscard]] double cell_at(int depth) const { return std::ldexp(frame_.size, -depth); }
  [[nodiscard]] Vec3d move_from(const Vec3d& origin) const { return origin - origin_; }
  void rebase(const Vec3d& origin, PointBuffers& points) {
    if (origin == origin_) return;
    for_each(ex_, "boolean.rebase", points.positions.size(), Rebase{move_from(origin), points.positions.view()});
  }

  Exec& ex_;
  Vec3d origin_;         // of the run
  octree::Frame frame_;  // of the run
  SheetSamples added_;
};

}  // namespace

template <exec::Space Exec>
BooleanResult combine(Exec& ex, const BooleanOperand& a, const BooleanOperand& b, BooleanOp op,
                      const BooleanOptions& options) {
  return Combination<Exec>(ex, a.origin()).run(a, b, op, options);
}

PSK_INSTANTIATE(combine);

}  // namespace pointskin::boolean
