#include "scene/deform_script.hpp"

#include <array>
#include <cstdint>
#include <numbers>

#include "scene/json_reader.hpp"

namespace pointskin::scene {
namespace {

using Value = JsonReader;

HandleRegion parse_region(const Value& region) {
  region.object({"half_space", "ball", "box", "capsule", "points"});
  if (region.size() != 1) region.refuse("must have one of half_space, ball, box, capsule, points");
  if (region.has("half_space")) {
    const Value at = region.at("half_space");
    at.object({"point", "normal"});
    return HalfSpace{at.at("point").vector(), at.at("normal").vector()};
  }
  if (region.has("ball")) {
    const Value at = region.at("ball");
    at.object({"centre", "radius"});
    return Ball{at.at("centre").vector(), at.at("radius").number()};
  }
  if (region.has("box")) {
    const Value at = region.at("box");
    at.object({"lower", "upper"});
    return AxisBox{at.at("lower").vector(), at.at("upper").vector()};
  }
  if (region.has("capsule")) {
    const Value at = region.at("capsule");
    at.object({"from", "to", "radius"});
    return Capsule{at.at("from").vector(), at.at("to").vector(), at.at("radius").number()};
  }
  const Value at = region.at("points");
  at.array();
  PointSet points;
  constexpr std::int64_t kLast = (std::int64_t{1} << 31) - 2;
  for (std::size_t i = 0; i < at.size(); ++i) points.points.push_back(at.at(i).whole_number(0, kLast));
  return points;
}

RigidMotion parse_rigid(const Value& rigid) {
  rigid.object({"axis", "point", "degrees", "radians", "translation"});
  if (rigid.has("degrees") && rigid.has("radians")) rigid.refuse("must not have both degrees and radians");
  RigidMotion motion;
  if (rigid.has("axis")) motion.axis = rigid.at("axis").vector();
  if (rigid.has("point")) motion.point = rigid.at("point").vector();
  if (rigid.has("degrees")) motion.angle = rigid.at("degrees").number() * std::numbers::pi / 180;
  if (rigid.has("radians")) motion.angle = rigid.at("radians").number();
  if (rigid.has("translation")) motion.translation = rigid.at("translation").vector();
  return motion;
}

AffineMap parse_affine(const Value& affine) {
  affine.object({"matrix", "pivot"});
  AffineMap map;
  const Value rows = affine.at("matrix");
  rows.array(3);
  for (std::size_t row = 0; row < 3; ++row) {
    rows.at(row).array(4);
    for (std::size_t column = 0; column < 4; ++column) map.matrix[4 * row + column] = rows.at(row).at(column).number();
  }
  if (affine.has("pivot")) map.pivot = affine.at("pivot").vector();
  return map;
}

Handle parse_handle(const Value& value) {
  value.object({"region", "rigid", "affine"});
  Handle handle;
  handle.region = parse_region(value.at("region"));
  if (value.has("rigid") && value.has("affine")) value.refuse("must not have both rigid and affine");
  if (value.has("rigid")) handle.transform = parse_rigid(value.at("rigid"));
  if (value.has("affine")) handle.transform = parse_affine(value.at("affine"));
  return handle;
}

void parse_block(const Value& value, Lattice& lattice) {
  if (value.has("box")) {
    if (value.has("origin") || value.has("axes")) value.refuse("must not have both box and origin or axes");
    const Value box = value.at("box");
    box.object({"lower", "upper"});
    lattice.origin = box.at("lower").vector();
    const Vec3d upper = box.at("upper").vector();
    for (std::size_t a = 0; a < 3; ++a) {
      if (!(upper[a] > lattice.origin[a])) box.refuse("lower must be below upper along every axis");
      lattice.axes[a] = {};
      lattice.axes[a][a] = upper[a] - lattice.origin[a];
    }
    return;
  }
  lattice.origin = value.at("origin").vector();
  const Value axes = value.at("axes");
  axes.array(3);
  for (std::size_t a = 0; a < 3; ++a) lattice.axes[a] = axes.at(a).vector();
}

void parse_moves(const Value& moves, Lattice& lattice) {
  moves.array();
  for (std::size_t m = 0; m < moves.size(); ++m) {
    const Value move = moves.at(m);
    move.object({"at", "by"});
    const Value at = move.at("at");
    at.array(3);
    std::array<int, 3> index{};
    for (std::size_t a = 0; a < 3; ++a) index[a] = static_cast<int>(at.at(a).whole_number(0, lattice.spans[a]));
    const Vec3d by = move.at("by").vector();
    Vec3d& point = lattice.control[lattice.index(index[0], index[1], index[2])];
    for (std::size_t a = 0; a < 3; ++a) point[a] += by[a];
  }
}

Lattice parse_lattice(const Value& value) {
  value.object({"box", "origin", "axes", "spans", "control", "moves", "outside"});
  Lattice lattice;
  parse_block(value, lattice);
  const Value spans = value.at("spans");
  spans.array(3);
  constexpr std::int64_t kMostSpans = 15;
  for (std::size_t a = 0; a < 3; ++a) lattice.spans[a] = static_cast<int>(spans.at(a).whole_number(1, kMostSpans));
  lattice.reset();
  if (value.has("control")) {
    const Value control = value.at("control");
    control.array(lattice.control.size());
    for (std::size_t i = 0; i < control.size(); ++i) lattice.control[i] = control.at(i).vector();
  }
  if (value.has("moves")) parse_moves(value.at("moves"), lattice);
  if (value.has("outside") && value.at("outside").one_of({"extend", "stay"}) == "stay")
    lattice.outside = Lattice::Outside::stay;
  return lattice;
}

}  // namespace

Deformation parse_deformation(const std::string& text, const std::string& name) {
  const nlohmann::json json = parse_json(text, name);
  const Value script(json, name);
  script.object({"handles", "lattices"});
  return read_deformation(script);
}

Deformation read_deformation(const JsonReader& script) {
  Deformation deformation;
  if (script.has("handles")) {
    const Value handles = script.at("handles");
    handles.array();
    for (std::size_t i = 0; i < handles.size(); ++i) deformation.handles.push_back(parse_handle(handles.at(i)));
  }
  if (script.has("lattices")) {
    const Value lattices = script.at("lattices");
    lattices.array();
    for (std::size_t i = 0; i < lattices.size(); ++i) deformation.lattices.push_back(parse_lattice(lattices.at(i)));
  }
  return deformation;
}

Deformation read_deformation(const std::string& path) { return parse_deformation(read_text(path), path); }

}  // namespace pointskin::scene
