#include <numbers>

#include "scene/deform_script.hpp"
#include "scene/vector_json.hpp"

namespace pointskin::scene {
namespace {

using Json = nlohmann::ordered_json;

struct RegionJson {
  Json operator()(const HalfSpace& at) const { return {{"half_space", {{"point", at.point}, {"normal", at.normal}}}}; }
  Json operator()(const Ball& at) const { return {{"ball", {{"centre", at.centre}, {"radius", at.radius}}}}; }
  Json operator()(const AxisBox& at) const { return {{"box", {{"lower", at.lower}, {"upper", at.upper}}}}; }
  Json operator()(const Capsule& at) const {
    return {{"capsule", {{"from", at.from}, {"to", at.to}, {"radius", at.radius}}}};
  }
  Json operator()(const PointSet& at) const { return {{"points", at.points}}; }
};

/// Degrees where they give the same angle back, as those do that were read; else radians.
void write_angle(double angle, Json& json) {
  const double degrees = angle * 180 / std::numbers::pi;
  const bool exact = degrees * std::numbers::pi / 180 == angle;
  json[exact ? "degrees" : "radians"] = exact ? degrees : angle;
}

void write_transform(const RigidMotion& motion, Json& json) {
  Json& rigid = json["rigid"] = {{"axis", motion.axis}, {"point", motion.point}};
  write_angle(motion.angle, rigid);
  rigid["translation"] = motion.translation;
}

void write_transform(const AffineMap& map, Json& json) {
  Json rows = Json::array();
  for (std::size_t row = 0; row < 3; ++row) {
    Json numbers = Json::array();
    for (std::size_t column = 0; column < 4; ++column) numbers.push_back(map.matrix[4 * row + column]);
    rows.push_back(std::move(numbers));
  }
  json["affine"] = {{"matrix", std::move(rows)}, {"pivot", map.pivot}};
}

Json to_json(const Handle& handle) {
  Json json = {{"region", std::visit(RegionJson(), handle.region)}};
  std::visit([&json](const auto& transform) { write_transform(transform, json); }, handle.transform);
  return json;
}

Json to_json(const Lattice& lattice) {
  return {{"origin", lattice.origin},
          {"axes", lattice.axes},
          {"spans", lattice.spans},
          {"control", lattice.control},
          {"outside", lattice.outside == Lattice::Outside::stay ? "stay" : "extend"}};
}

}  // namespace

void write_deformation(const Deformation& deformation, Json& json) {
  json["handles"] = Json::array();
  for (const Handle& handle : deformation.handles) json["handles"].push_back(to_json(handle));
  json["lattices"] = Json::array();
  for (const Lattice& lattice : deformation.lattices) json["lattices"].push_back(to_json(lattice));
}

}  // namespace pointskin::scene
