#include "fluid/frames.hpp"

#include <pointskin/error.hpp>

#include <cstddef>
#include <limits>
#include <utility>

#include "exec/this_space.hpp"
#include "octree/bounding_box.hpp"
#include "reconstruct/kept_names.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/point_hash.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::fluid {
namespace {

/// What a look over all particles tells.
struct ParticleCheck {
  Bounds box;
  std::int64_t not_finite = 0;
};
struct CheckParticle {
  ArrayView<const Vec3f> positions;
  PSK_HD ParticleCheck operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return {{p, p}, detail::is_finite(p) ? 0 : 1};
  }
};
struct JoinChecks {
  PSK_HD ParticleCheck operator()(const ParticleCheck& a, const ParticleCheck& b) const {
    return {octree::JoinBoxes{}(a.box, b.box), a.not_finite + b.not_finite};
  }
};

/// @throws Error empty_result, over_limit
void require_particles(const detail::Input& input) {
  if (input.size() == 0) throw Error(ErrorCode::empty_result, "there are no particles; nothing to make a surface of");
  if (input.size() > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "there are more than 2^31 - 1 particles; split the frame");
}

template <exec::Space Exec>
exec::Buffer<Vec3f> positions_of(Exec& ex, const detail::Input& input) {
  if (input.points() != nullptr) return detail::borrowed(input.points()->positions);
  auto positions = exec::make_buffer<Vec3f>(ex, input.size());
  copy_to_device(ex, input.cloud()->positions.data(), positions.view());
  return positions;
}

/// Under the names that they have on the mesh.
template <exec::Space Exec>
void load_values(Exec& ex, const detail::Input& input, Frame& frame) {
  std::vector<detail::AttributeBuffer> attributes = detail::upload_attributes(ex, input, "particles");
  std::vector<std::string> given;
  for (const detail::AttributeBuffer& attribute : attributes) given.push_back(attribute.name);
  const std::vector<std::string> names = detail::kept_names(given, false, false);
  for (std::size_t a = 0; a < names.size(); ++a) {
    frame.values.push_back(std::move(attributes[a].values));
    frame.particles.values.push_back({names[a], frame.values.back().view()});
  }
}

}  // namespace

template <exec::Space Exec>
Frame load_frame(Exec& ex, const detail::Input& input, const FluidOptions& options) {
  require_particles(input);
  Frame frame;
  frame.positions = positions_of(ex, input);
  frame.particles.positions = frame.positions.cview();
  const auto check = exec::reduce<ParticleCheck>(ex, "upload.check", input.size(),
                                                 CheckParticle{frame.positions.cview()}, JoinChecks{});
  if (check.not_finite > 0)
    throw Error(ErrorCode::invalid_input,
                std::to_string(check.not_finite) + " particles have coordinates that are not finite; leave them out");
  frame.particles.bounds = check.box;
  if (options.attributes) load_values(ex, input, frame);
  return frame;
}

template <exec::Space Exec>
void download_surface(Exec& ex, FluidSurface made, const std::vector<std::string>& names, const Vec3d& origin,
                      Mesh& mesh, FluidReport& report) {
  detail::PhaseClock clock(ex);
  mesh.origin = origin;
  detail::download_array(ex, made.mesh.positions, mesh.vertices);
  detail::download_array(ex, made.mesh.normals, mesh.normals);
  detail::download_array(ex, made.mesh.triangles, mesh.triangles);
  mesh.attributes.resize(made.values.size());
  for (std::size_t a = 0; a < made.values.size(); ++a) {
    mesh.attributes[a].name = names[a];
    exec::download_typed(ex, std::move(made.values[a]), mesh.attributes[a].values);
  }
  clock.lap(report.download_ms);
  clock.read();
  report.device_peak_bytes = ex.pool()->peak_bytes();
}

PSK_INSTANTIATE(load_frame);
PSK_INSTANTIATE(download_surface);

}  // namespace pointskin::fluid
