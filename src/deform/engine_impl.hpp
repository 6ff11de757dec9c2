// What a Deformer delegates to, once for every space.
#pragma once

#include <pointskin/error.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "deform/engine.hpp"
#include "deform/prepare_deformation.hpp"
#include "deform/rest.hpp"
#include "deform/spacing.hpp"
#include "reconstruct/kept_names.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/within_envelope.hpp"

namespace pointskin::detail {

/// Chosen points of the rest cloud, ready for searches; and what has been found for the rest samples.
struct ChosenPoints {
  std::vector<std::int64_t> points;  ///< the caller's list
  exec::Buffer<Vec3f> positions;     ///< in its order
  exec::Buffer<Vec3f> sorted_unit;
  exec::Buffer<std::int32_t> order;
  octree::OctreeData tree;
  exec::Buffer<std::int32_t> nearest_at_rest;  ///< (n) index in `positions`
  bool in_use = false;
};

template <exec::Space Exec>
class DeformOn final : public DeformEngine {
 public:
  DeformOn(std::shared_ptr<Exec> ex, const Cloud& cloud, const Options& options, DeformReport& report)
      : ex_(std::move(ex)), options_(options) {
    ex_->activate();
    Stopwatch watch;
    envelope_ = make_envelope(*ex_, options, cloud.origin);
    PointBuffers points = upload(*ex_, cloud);
    Options all = options;
    all.attributes = true;
    points.attributes = upload_attributes(*ex_, cloud, all);
    std::vector<std::string> mesh_names;
    for (std::size_t a = 0; a < points.attributes.size(); ++a)
      mesh_names.push_back(std::exchange(points.attributes[a].name, cloud.attributes[a].name));
    ex_->synchronize();
    report.upload_ms = watch.lap();
    rest_ = make_rest(*ex_, std::move(points), cloud.origin, options, report.run);
    rest_.mesh_names = std::move(mesh_names);
    for (Vec3d& p : report.run.farthest_strays)
      for (std::size_t a = 0; a < 3; ++a) p[a] += cloud.origin[a];
    ex_->synchronize();
    report.rest_ms = watch.lap();
    options_.keep_strays = true;  // they are left out already
    report.rest_points = rest_.size();
    deform({}, report);
  }

  void deform(const Deformation& deformation, DeformReport& report) override {
    ex_->activate();
    const deform::PreparedDeformation prepared = deform::prepare(deformation, rest_.origin);
    if (prepared.identity)
      stay(report);
    else
      move(prepared, report);
    report.points = samples_.positions.size();
    report.inserted = samples_.inserted;
    report.thinned = samples_.thinned;
  }

  void reconstruct(Mesh& mesh, DeformReport& report) override {
    ex_->activate();
    Stopwatch watch;
    ex_->pool()->reset_peak();
    const std::int64_t strays = report.run.strays;
    std::vector<Vec3d> farthest = std::move(report.run.farthest_strays);
    report.run = {};
    PointBuffers points{std::move(samples_.positions), std::move(samples_.normals)};
    const auto put_back = [&] {
      samples_.positions = std::move(points.positions);
      samples_.normals = std::move(points.normals);
    };
    try {
      if (options_.attributes)
        for (std::size_t a = 0; a < rest_.attributes.size(); ++a)
          points.attributes.push_back({rest_.mesh_names[a], attribute(a)});
      FieldData data = fit_field(*ex_, points, {.keep_points = true, .envelope = envelope_}, options_, report.run);
      put_back();
      if (options_.progress && !options_.progress({"extract", 0.8}))
        throw Error(ErrorCode::interrupted, "cancelled before the phase \"extract\"");
      make_field(ex_, std::move(data), options_, rest_.origin)->extract_and_release(mesh, report.run);
    } catch (...) {
      if (samples_.positions.empty()) put_back();
      throw;
    }
    report.run.strays = strays;
    report.run.farthest_strays = std::move(farthest);
    report.mesh_ms = watch.lap();
  }

  [[nodiscard]] Cloud cloud() const override {
    ex_->activate();
    Cloud out;
    out.origin = rest_.origin;
    copy_out(samples_.positions, out.positions);
    copy_out(samples_.normals, out.normals);
    for (std::size_t a = 0; a < rest_.attributes.size(); ++a)
      out.attributes.push_back({rest_.attributes[a].name, exec::download_typed(*ex_, attribute(a))});
    return out;
  }

  [[nodiscard]] SpacingRatios spacing() const override {
    ex_->activate();
    if (rest_.size() < 2 || samples_.positions.size() < 2) return {};
    if (rest_distances_.empty()) rest_distances_ = neighbour_distances(*ex_, rest_.positions.cview());
    const std::vector<float> now = neighbour_distances(*ex_, samples_.positions.cview());
    std::vector<std::int32_t> parents;
    copy_out(samples_.parents, parents);
    return spacing_ratios(now, rest_distances_, parents);
  }

 private:
  class Stopwatch {
   public:
    /// Milliseconds since the last lap.
    double lap() {
      const auto now = std::chrono::steady_clock::now();
      return std::chrono::duration<double, std::milli>(now - std::exchange(start_, now)).count();
    }

   private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  };

  void stay(DeformReport& report) {
    PhaseClock clock(*ex_);
    samples_ = {};
    samples_.positions = exec::make_buffer<Vec3f>(*ex_, rest_.size());
    samples_.normals = exec::make_buffer<Vec3f>(*ex_, rest_.size());
    copy(*ex_, rest_.positions.cview(), samples_.positions.view());
    copy(*ex_, rest_.normals.cview(), samples_.normals.view());
    samples_.parents = exec::iota(*ex_, rest_.size());
    clock.lap(report.sample_ms);
    clock.read();
    report.map_ms = 0;
  }

  void move(const deform::PreparedDeformation& prepared, DeformReport& report) {
    PhaseClock clock(*ex_);
    const exec::Buffer<deform::HandleData> handles = on_device(prepared.handles);
    const exec::Buffer<deform::LatticeData> lattices = on_device(prepared.lattices);
    const exec::Buffer<Double3> moves = on_device(prepared.moves);
    find_chosen(prepared);
    deform::MapView map{handles.cview(), lattices.cview(), moves.cview(), {}, 0};

    exec::Buffer<Vec3f> nearest = nearest_at_rest(prepared);
    map.nearest = nearest.cview();
    map.nearest_stride = rest_.size();
    deform::Resampled samples = deform::resample(*ex_, map, rest_.samples(), rest_.surface());
    clock.lap(report.sample_ms);
    if (!prepared.point_sets.empty()) {
      nearest = nearest_to(prepared, samples.positions);
      map.nearest = nearest.cview();
      map.nearest_stride = samples.positions.size();
    }
    deform::map_samples(*ex_, map, samples.positions.view(), samples.normals.view());
    samples_ = std::move(samples);
    clock.lap(report.map_ms);
    clock.read();
  }

  template <class T>
  exec::Buffer<T> on_device(const std::vector<T>& from) const {
    auto to = exec::make_buffer<T>(*ex_, static_cast<std::int64_t>(from.size()));
    if (!from.empty()) copy_to_device(*ex_, from.data(), to.view());
    return to;
  }

  template <class T>
  void copy_out(const exec::Buffer<T>& from, std::vector<T>& to) const {
    to.resize(static_cast<std::size_t>(from.size()));
    copy_to_host(*ex_, from.cview(), to.data());
  }

  [[nodiscard]] exec::TypedBuffer attribute(std::size_t a) const {
    return exec::gather_typed(*ex_, rest_.attributes[a].values.view(), samples_.parents.cview());
  }

  /// Makes the lists of points ready that are new, and forgets those that are no longer used.
  void find_chosen(const deform::PreparedDeformation& prepared) {
    for (ChosenPoints& chosen : chosen_) chosen.in_use = false;
    for (const std::vector<std::int64_t>& points : prepared.point_sets) {
      auto known = std::find_if(chosen_.begin(), chosen_.end(),
                                [&](const ChosenPoints& chosen) { return chosen.points == points; });
      if (known == chosen_.end()) known = chosen_.insert(chosen_.end(), choose(points));
      known->in_use = true;
    }
    std::erase_if(chosen_, [](const ChosenPoints& chosen) { return !chosen.in_use; });
  }

  [[nodiscard]] ChosenPoints choose(const std::vector<std::int64_t>& points) const {
    ChosenPoints out;
    out.points = points;
    out.positions = rest::gathered(*ex_, rest_.caller_positions,
                                   on_device(std::vector<std::int32_t>(points.begin(), points.end())));
    const std::int64_t n = out.positions.size();
    const exec::Buffer<Vec3f> unit = to_unit(out.positions);
    auto ties = exec::make_buffer<std::uint64_t>(*ex_, n);
    for_each(*ex_, "deform.choose", n, rest::HashPoint{out.positions.cview(), out.positions.cview(), {}, ties.view()});
    octree::SortedPoints sorted = octree::sort_points(*ex_, unit.cview(), ties.cview());
    out.tree = octree::build_octree(*ex_, sorted.keys.cview(), rest_.field.tree.depth);
    out.sorted_unit = rest::gathered(*ex_, unit, sorted.order);
    out.order = std::move(sorted.order);
    out.nearest_at_rest = search(out, rest_.unit);
    return out;
  }

  [[nodiscard]] exec::Buffer<Vec3f> to_unit(const exec::Buffer<Vec3f>& positions) const {
    auto unit = exec::make_buffer<Vec3f>(*ex_, positions.size());
    for_each(*ex_, "deform.choose", positions.size(),
             octree::ToUnit{rest_.field.frame, positions.cview(), unit.view()});
    return unit;
  }

  [[nodiscard]] exec::Buffer<std::int32_t> search(const ChosenPoints& chosen,
                                                  const exec::Buffer<Vec3f>& queries) const {
    auto ids = exec::make_buffer<std::int32_t>(*ex_, queries.size());
    auto squared = exec::make_buffer<float>(*ex_, queries.size());
    octree::find_nearest(*ex_, {chosen.tree.view(), chosen.sorted_unit.cview(), chosen.order.cview()}, queries.cview(),
                         1, ids.view(), squared.view());
    return ids;
  }

  [[nodiscard]] const ChosenPoints& chosen(const std::vector<std::int64_t>& points) const {
    return *std::find_if(chosen_.begin(), chosen_.end(), [&](const ChosenPoints& c) { return c.points == points; });
  }

  /// Row r: for every rest sample the nearest point of list r.
  [[nodiscard]] exec::Buffer<Vec3f> nearest_at_rest(const deform::PreparedDeformation& prepared) const {
    return rows(prepared, rest_.size(), [](const ChosenPoints& c) { return c.nearest_at_rest.cview(); });
  }

  /// The same for other points of the rest pose.
  [[nodiscard]] exec::Buffer<Vec3f> nearest_to(const deform::PreparedDeformation& prepared,
                                               const exec::Buffer<Vec3f>& positions) const {
    const exec::Buffer<Vec3f> unit = to_unit(positions);
    exec::Buffer<std::int32_t> ids;
    return rows(prepared, positions.size(), [&](const ChosenPoints& c) {
      ids = search(c, unit);
      return ids.cview();
    });
  }

  template <class Ids>
  [[nodiscard]] exec::Buffer<Vec3f> rows(const deform::PreparedDeformation& prepared, std::int64_t n,
                                         const Ids& ids_of) const {
    const auto count = static_cast<std::int64_t>(prepared.point_sets.size());
    auto out = exec::make_buffer<Vec3f>(*ex_, count * n);
    for (std::int64_t r = 0; r < count; ++r) {
      const ChosenPoints& c = chosen(prepared.point_sets[static_cast<std::size_t>(r)]);
      exec::gather<Vec3f>(*ex_, c.positions.cview(), ids_of(c), out.view().part(r * n, n));
    }
    return out;
  }

  std::shared_ptr<Exec> ex_;
  Options options_;
  std::shared_ptr<const envelope::Envelope> envelope_;
  RestCloud rest_;
  deform::Resampled samples_;  ///< deformed
  std::vector<ChosenPoints> chosen_;
  mutable std::vector<float> rest_distances_;  ///< measured when first asked for
};

}  // namespace pointskin::detail
