#include "water.hpp"

#include <pointskin/error.hpp>

#include <chrono>
#include <utility>

#include "scene/json_reader.hpp"

namespace pointskin::studio {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostForces = 6;  // a scene may have one of its own

simulation::Scene scene_named(const std::string& name, std::int64_t particles) {
  const auto kind = simulation::parse_scene(name);
  if (!kind) throw Error(ErrorCode::usage, "there is no scene '" + name + "'");
  return make_scene(*kind, particles);
}

Json json_of(const Vec3f& v) { return {v.x, v.y, v.z}; }

}  // namespace

Vec3f to_floats(const Vec3d& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

Water::Water(const std::string& scene, std::int64_t particles, Workspace workspace)
    : simulation_(scene_named(scene, particles), {}, std::move(workspace)), scene_(scene) {}

void Water::set_forces(std::vector<simulation::Interaction> forces) {
  if (forces.size() > kMostForces) throw Error(ErrorCode::usage, "more than 6 forces at once");
  forces_ = std::move(forces);
}

void Water::restart() {
  simulation_.restart();
  forces_.clear();
}

const Mesh& Water::next_frame() {
  simulation_.step(kSecondsPerFrame, forces_);
  const auto start = std::chrono::steady_clock::now();
  simulation_.surface({}, mesh_);
  surface_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return mesh_;
}

Json Water::facts() const {
  const simulation::SimulationReport& report = simulation_.report();
  const simulation::Obstacle obstacle = simulation_.obstacle();
  const Vec3f& tank = simulation_.scene().tank;
  Json json = {{"scene", scene_},
               {"index", report.frame},
               {"seconds", report.seconds},
               {"particles", report.particles},
               {"max_speed", report.max_speed},
               {"tank", json_of(tank)}};
  json["obstacle"] =
      obstacle.radius > 0 ? Json{{"centre", json_of(obstacle.centre)}, {"radius", obstacle.radius}} : Json(nullptr);
  json["ms"] = {{"simulate", report.ms}, {"surface", surface_ms_}};
  return json;
}

simulation::Interaction force_of(const nlohmann::json& json) {
  const scene::JsonReader reader(json, "force");
  reader.object({"kind", "centre", "direction", "radius", "strength"});
  simulation::Interaction force;
  if (reader.has("kind") && reader.at("kind").one_of({"push", "swirl"}) == "swirl")
    force.kind = simulation::Interaction::Kind::swirl;
  force.centre = to_floats(reader.at("centre").vector());
  force.direction = to_floats(reader.at("direction").vector());
  if (reader.has("radius")) force.radius = static_cast<float>(reader.at("radius").number());
  if (reader.has("strength")) force.strength = static_cast<float>(reader.at("strength").number());
  return force;
}

}  // namespace pointskin::studio
