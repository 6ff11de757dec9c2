#pragma once

#include <pointskin/error.hpp>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "exec/algorithms.hpp"
#include "exec/host_array.hpp"
#include "fluid/engine.hpp"
#include "fluid/surface.hpp"
#include "octree/bounding_box.hpp"
#include "reconstruct/kept_names.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::detail {

/// What a look over all particles tells.
struct ParticleCheck {
  Bounds box;
  std::int64_t not_finite = 0;
};
struct CheckParticle {
  ArrayView<const Vec3f> positions;
  PSK_HD ParticleCheck operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    const float sum = 0 * p.x + 0 * p.y + 0 * p.z;  // anything not finite becomes NaN
    return {{p, p}, sum == 0 ? 0 : 1};
  }
};
struct JoinChecks {
  PSK_HD ParticleCheck operator()(const ParticleCheck& a, const ParticleCheck& b) const {
    return {octree::JoinBoxes{}(a.box, b.box), a.not_finite + b.not_finite};
  }
};

template <exec::Space Exec>
class FluidEngineOn final : public FluidEngine {
 public:
  explicit FluidEngineOn(std::shared_ptr<Exec> ex) : ex_(std::move(ex)) {}

  void surface(const Cloud& particles, const FluidOptions& options, Mesh& mesh, FluidReport& report) override {
    ex_->activate();
    ex_->pool()->reset_peak();
    report = {};
    PhaseClock clock(*ex_);
    fluid::Particles on_device = upload(particles, options);
    clock.lap(report.upload_ms);
    clock.read();
    fluid::FluidSurface made = fluid::make_surface(*ex_, on_device, options, report);
    positions_.reset();
    values_.clear();
    PhaseClock downloading(*ex_);
    download(std::move(made), on_device, particles.origin, mesh);
    downloading.lap(report.download_ms);
    downloading.read();
    report.device_peak_bytes = ex_->pool()->peak_bytes();
  }

 private:
  /// @throws Error as FluidSurfacer::surface
  fluid::Particles upload(const Cloud& cloud, const FluidOptions& options) {
    if (cloud.positions.empty())
      throw Error(ErrorCode::empty_result, "there are no particles; nothing to make a surface of");
    if (cloud.size() > std::numeric_limits<std::int32_t>::max())
      throw Error(ErrorCode::over_limit, "there are more than 2^31 - 1 particles; split the frame");
    positions_ = exec::make_buffer<Vec3f>(*ex_, cloud.size());
    copy_to_device(*ex_, cloud.positions.data(), positions_.view());
    fluid::Particles particles{positions_.cview()};
    const auto check = exec::reduce<ParticleCheck>(*ex_, "upload.check", cloud.size(),
                                                   CheckParticle{positions_.cview()}, JoinChecks{});
    if (check.not_finite > 0)
      throw Error(ErrorCode::invalid_input,
                  std::to_string(check.not_finite) + " particles have coordinates that are not finite; leave them out");
    particles.bounds = check.box;
    if (options.attributes) upload_values(cloud, particles);
    return particles;
  }

  void upload_values(const Cloud& cloud, fluid::Particles& particles) {
    std::vector<std::string> given;
    for (const Attribute& attribute : cloud.attributes) given.push_back(attribute.name);
    const std::vector<std::string> names = kept_names(given, false, false);
    for (std::size_t a = 0; a < names.size(); ++a) {
      const Attribute& from = cloud.attributes[a];
      const auto n = static_cast<std::int64_t>(from.values.size());
      if (n != cloud.size())
        throw Error(ErrorCode::invalid_input, "the attribute " + from.name + " has " + std::to_string(n) +
                                                  " values for " + std::to_string(cloud.size()) + " particles");
      values_.push_back(exec::upload_typed(*ex_, from.values));
      particles.values.push_back({names[a], values_.back().view()});
    }
  }

  void download(fluid::FluidSurface made, const fluid::Particles& particles, const Vec3d& origin, Mesh& mesh) {
    mesh.origin = origin;
    download_array(*ex_, made.mesh.positions, mesh.vertices);
    download_array(*ex_, made.mesh.normals, mesh.normals);
    download_array(*ex_, made.mesh.triangles, mesh.triangles);
    mesh.attributes.resize(made.values.size());
    for (std::size_t a = 0; a < made.values.size(); ++a) {
      mesh.attributes[a].name = particles.values[a].name;
      download_typed(*ex_, std::move(made.values[a]), mesh.attributes[a].values);
    }
  }

  std::shared_ptr<Exec> ex_;
  exec::Buffer<Vec3f> positions_;
  std::vector<exec::TypedBuffer> values_;
};

}  // namespace pointskin::detail
