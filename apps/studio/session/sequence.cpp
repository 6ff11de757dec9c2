#include "sequence.hpp"

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <string>
#include <utility>

#include "scene/spacing.hpp"

namespace pointskin::studio {
namespace {

std::int64_t bytes_of(const Mesh& mesh) {
  std::int64_t bytes =
      static_cast<std::int64_t>(mesh.vertices.size() * sizeof(Vec3f) + mesh.normals.size() * sizeof(Vec3f) +
                                mesh.triangles.size() * sizeof(Triangle));
  for (const Attribute& attribute : mesh.attributes) bytes += static_cast<std::int64_t>(attribute.values.bytes());
  return bytes;
}

/// Particles of water in motion are nearer to their nearest neighbour than they rest apart, by about this.
constexpr double kRestOverNearest = 1.1;

double radius_of(const std::filesystem::path& file) {
  const Cloud particles = read_cloud(file.string());
  const double radius = kRestOverNearest * scene::median_spacing(particles.positions) / 2;
  if (!(radius > 0)) throw Error(ErrorCode::invalid_input, file.string() + ": holds fewer than two particles");
  return radius;
}

}  // namespace

Sequence::Sequence(std::vector<std::filesystem::path> files, const SequenceOptions& options, Workspace workspace)
    : files_(std::move(files)), most_bytes_(options.most_bytes), surfacer_(std::move(workspace)) {
  if (files_.empty()) throw Error(ErrorCode::usage, "a sequence needs a file");
  surface_.particle_radius = options.particle_radius > 0 ? options.particle_radius : radius_of(files_.front());
  validate(surface_);
}

std::shared_ptr<const Mesh> Sequence::frame(std::int64_t frame) {
  if (frame < 0 || frame >= size())
    throw Error(ErrorCode::usage, "frame " + std::to_string(frame) + " is not in [0, " + std::to_string(size()) + ")");
  if (const auto found = kept_.find(frame); found != kept_.end()) {
    lately_.splice(lately_.begin(), lately_, found->second.place);
    return found->second.mesh;
  }
  auto mesh = make(frame);
  kept_bytes_ += bytes_of(*mesh);
  lately_.push_front(frame);
  kept_[frame] = {mesh, lately_.begin()};
  while (kept_bytes_ > most_bytes_ && lately_.size() > 1) forget_oldest();
  return mesh;
}

bool Sequence::make_ahead(std::int64_t frame) {
  const std::int64_t mean = lately_.empty() ? 0 : kept_bytes_ / static_cast<std::int64_t>(lately_.size());
  for (std::int64_t step = 1; step < size(); ++step) {
    if (step > 1 && mean * step > most_bytes_ / 2) return false;  // it would drive out what is to be shown before
    const std::int64_t next = (frame + step) % size();
    if (has(next)) continue;
    this->frame(next);
    return true;
  }
  return false;
}

std::shared_ptr<const Mesh> Sequence::make(std::int64_t frame) {
  const std::string file = files_[static_cast<std::size_t>(frame)].string();
  auto mesh = std::make_shared<Mesh>();
  try {
    surfacer_.surface(read_cloud(file), surface_, *mesh);
  } catch (const Error& error) {
    throw error.while_doing("making the surface of " + file);
  }
  return mesh;
}

void Sequence::forget_oldest() {
  const auto oldest = kept_.find(lately_.back());
  kept_bytes_ -= bytes_of(*oldest->second.mesh);
  lately_.pop_back();
  kept_.erase(oldest);
}

}  // namespace pointskin::studio
