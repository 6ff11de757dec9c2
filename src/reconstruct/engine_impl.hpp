// What a Reconstructor delegates to, once for every space.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "reconstruct/detail.hpp"
#include "reconstruct/engine.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/thin.hpp"
#include "reconstruct/within_envelope.hpp"

namespace pointskin::detail {

template <exec::Space Exec>
class EngineOn final : public Engine {
 public:
  explicit EngineOn(std::shared_ptr<Exec> ex) : ex_(std::move(ex)) {}

  void limit_memory(std::int64_t bytes) override { ex_->pool()->set_limit(bytes); }

  void release_memory() override {
    ex_->activate();
    ex_->pool()->trim();
  }

  std::shared_ptr<FieldImpl> solve(const Input& input, const Options& options, RunReport& report) override {
    const Cloud& cloud = input.cloud;
    ex_->activate();
    ex_->pool()->reset_peak();
    std::shared_ptr<const envelope::Envelope> envelope = make_envelope(*ex_, options, cloud.origin);
    PhaseClock clock(*ex_);
    PointBuffers points = upload(*ex_, input, options);
    clock.lap(report.upload_ms);
    clock.read();
    FieldData data = fit_field(*ex_, points, {.envelope = std::move(envelope), .look = true}, options, report);
    for (Vec3d& p : report.farthest_strays)
      for (std::size_t a = 0; a < 3; ++a) p[a] += cloud.origin[a];
    report.device_peak_bytes = ex_->pool()->peak_bytes();
    return make_field(ex_, std::move(data), options, cloud.origin);
  }

  Cloud thin(const Cloud& cloud, const Options& options, std::int64_t count) override {
    ex_->activate();
    return thin_cloud(*ex_, detail::upload(*ex_, cloud), options, count);
  }

  Detail measure_detail(const Cloud& cloud, const Options& options) override {
    ex_->activate();
    return detail::measure_detail(*ex_, cloud, options);
  }

  std::vector<RunTimes> repeat(const Input& input, const Options& options, int times) override {
    ex_->activate();
    const FitSetup setup{
        .keep_points = true, .envelope = make_envelope(*ex_, options, input.cloud.origin), .look = true};
    PointBuffers points = upload(*ex_, input, options);
    std::vector<RunTimes> runs;
    for (int i = 0; i < times; ++i) {
      PhaseClock clock(*ex_);
      RunReport report;
      FieldData data = fit_field(*ex_, points, setup, options, report);
      const surface::Surface surface = detail::extract(*ex_, data, options, report);
      look_at_surface(*ex_, surface, data);
      const auto drop = [](std::size_t, const exec::TypedBuffer&) {};
      field::interpolate(*ex_, data.tree, data.attributes, surface.positions.cview(), drop);
      field::find_labels(*ex_, data.tree, data.attributes, surface.positions.cview(), drop);
      RunTimes run{report.octree_ms, report.splat_ms, report.solve_ms};
      clock.lap(run.total_ms);
      clock.read();
      run.extract_ms = run.total_ms - run.octree_ms - run.splat_ms - run.solve_ms;
      run.vertices = surface.positions.size();
      run.triangles = surface.triangles.size();
      runs.push_back(run);
    }
    return runs;
  }

 private:
  static PointBuffers upload(Exec& ex, const Input& input, const Options& options) {
    PointBuffers points = detail::upload(ex, input.cloud);
    if (input.turned) turn_normals(ex, points.normals.view());
    points.attributes = upload_attributes(ex, input.cloud, options);
    return points;
  }

  std::shared_ptr<Exec> ex_;
};

}  // namespace pointskin::detail
