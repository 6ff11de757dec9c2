// What pages are told of the scene: the event `state`.
#include <cmath>
#include <filesystem>
#include <utility>

#include "scene/options.hpp"
#include "scene/vector_json.hpp"
#include "scene_desk.hpp"

namespace pointskin::studio {
namespace {

/// Long lists of an operation are of use to the engine alone; the history shows the rest.
constexpr const char* kLong[] = {"camera", "stroke", "area", "rectangle", "lattices"};

Json brief(Json operation) {
  for (const char* key : kLong) operation.erase(key);
  return operation;
}

std::string name_of_cloud(const scene::CloudSource& source) {
  return source.shape.empty() ? std::filesystem::path(source.file).filename().string() : source.shape;
}

}  // namespace

Json SceneDesk::topology_json(std::size_t state) const {
  if (state >= surfaces_.size() || !surfaces_[state]) return nullptr;
  const MeshReport& report = *surfaces_[state];
  const auto genus = report.components - static_cast<std::int64_t>(std::floor(static_cast<double>(report.euler) / 2));
  return {{"components", report.components}, {"genus", genus}, {"euler", report.euler}};
}

Json SceneDesk::record_json(std::size_t i) const {
  const scene::StepRecord& record = scene_->record(i);
  Json json = {{"operation", record.operation}, {"added", record.added},      {"removed", record.removed},
               {"flipped", record.flipped},     {"points", record.points},    {"triangles", record.triangles},
               {"snapped", record.snapped},     {"before", topology_json(i)}, {"after", topology_json(i + 1)},
               {"notes", record.notes}};
  json["warm"] = record.warm;
  json["edit_ms"] = record.edit_ms;
  json["reconstruct_ms"] = record.reconstruct_ms;
  json["total_ms"] = record.total_ms;
  return json;
}

Json SceneDesk::entry(std::size_t i) const {
  return {{"operation", brief(scene::to_json(scene_->operation(i), {}))}, {"record", record_json(i)}};
}

Json SceneDesk::surface_json() const {
  const std::size_t done = scene_->done();
  if (done >= surfaces_.size() || !surfaces_[done]) return nullptr;
  const MeshReport& r = *surfaces_[done];
  return {{"vertices", r.vertices},
          {"triangles", r.triangles},
          {"boundary_edges", r.boundary_edges},
          {"closed", r.closed()},
          {"manifold", r.manifold()},
          {"watertight", r.watertight()},
          {"volume", r.volume},
          {"area", r.area}};
}

void SceneDesk::tell_state() const {
  const Json event = state();
  services_.audience.remember("state", {event});
  services_.audience.tell(event);
}

Json SceneDesk::state() const {
  Json event = {{"event", "state"}, {"scene", nullptr}};
  if (scene_ == nullptr) return event;
  const auto world = [this](const Vec3f& v) {
    const Vec3d& o = points_.origin;
    return Json{o.x + double{v.x}, o.y + double{v.y}, o.z + double{v.z}};
  };
  const Json box = {{"lower", world(points_.box.lower)}, {"upper", world(points_.box.upper)}};
  Json clouds = Json::array();
  for (const scene::CloudSource& source : base_.clouds)
    clouds.push_back({{"name", name_of_cloud(source)}, {"file", source.file}, {"shape", source.shape}});
  for (Json& cloud : clouds)  // merged, they have all in common
    cloud.update({{"points", points_.count},
                  {"normals", points_.has_normals},
                  {"box", box},
                  {"shift", points_.origin},
                  {"dropped", dropped_}});
  Json history = Json::array();
  for (std::size_t i = 0; i < scene_->size(); ++i) history.push_back(entry(i));
  const std::string more = clouds.size() > 1 ? " and " + std::to_string(clouds.size() - 1) + " more" : "";
  Json scene = {{"base_label", clouds.empty() ? "" : clouds[0]["name"].get<std::string>() + more}};
  scene["clouds"] = std::move(clouds);
  scene.update({{"points", points_.count}, {"normals", points_.has_normals}, {"box", box}});
  scene["shift"] = points_.origin;
  scene["dropped"] = dropped_;
  scene["options"] = scene::options_json(scene_->options());
  scene["history"] = std::move(history);
  scene["done"] = scene_->done();
  scene["triangles"] = scene_->mesh().triangles.size();
  scene["topology"] = topology_json(scene_->done());
  scene["surface"] = surface_json();
  scene["journal"] = journal_ ? journal_->path() : "";
  event["scene"] = std::move(scene);
  return event;
}

}  // namespace pointskin::studio
