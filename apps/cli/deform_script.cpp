#include "deform_script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <iostream>
#include <iterator>
#include <numbers>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>

#include "console.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::json;

/// A value and where it is.
class Value {
 public:
  Value(const Json& json, std::string place) : json_(json), place_(std::move(place)) {}

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::invalid_input, one_line(fmt::format("{}: {}", place_, what)));
  }

  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }
  [[nodiscard]] Value member(const char* key) const {
    if (!json_.contains(key)) refuse(fmt::format("needs the key '{}'", key));
    return {json_.at(key), fmt::format("{}.{}", place_, key)};
  }
  [[nodiscard]] std::size_t size() const { return json_.size(); }
  [[nodiscard]] Value at(std::size_t i) const { return {json_.at(i), fmt::format("{}[{}]", place_, i)}; }

  /// Complains unless this is an object with some of these keys alone.
  void object(std::initializer_list<std::string_view> keys) const {
    if (!json_.is_object()) refuse("must be an object { }");
    for (const auto& [key, unused] : json_.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        refuse(fmt::format("does not know the key '{}'", key));
  }
  void array() const {
    if (!json_.is_array()) refuse("must be a list [ ]");
  }
  void array(std::size_t count) const {
    if (!json_.is_array() || json_.size() != count) refuse(fmt::format("must be a list of {}", count));
  }

  [[nodiscard]] double number() const {
    if (!json_.is_number() || !std::isfinite(json_.get<double>())) refuse("must be a number");
    return json_.get<double>();
  }
  [[nodiscard]] std::int64_t whole_number(std::int64_t lowest, std::int64_t highest) const {
    const bool whole =
        json_.is_number_integer() && (!json_.is_number_unsigned() || json_.get<std::uint64_t>() >> 63 == 0);
    if (!whole || json_.get<std::int64_t>() < lowest || json_.get<std::int64_t>() > highest)
      refuse(fmt::format("must be a whole number in {}..{}", lowest, highest));
    return json_.get<std::int64_t>();
  }
  [[nodiscard]] Vec3d vector() const {
    array(3);
    return {at(0).number(), at(1).number(), at(2).number()};
  }
  [[nodiscard]] std::string one_of(std::initializer_list<std::string_view> words) const {
    if (json_.is_string())
      for (const std::string_view word : words)
        if (json_.get<std::string>() == word) return std::string(word);
    refuse(fmt::format("must be one of {}", fmt::join(words, ", ")));
  }

 private:
  const Json& json_;
  std::string place_;
};

HandleRegion parse_region(const Value& region) {
  region.object({"half_space", "ball", "box", "capsule", "points"});
  if (region.size() != 1) region.refuse("must have one of half_space, ball, box, capsule, points");
  if (region.has("half_space")) {
    const Value at = region.member("half_space");
    at.object({"point", "normal"});
    return HalfSpace{at.member("point").vector(), at.member("normal").vector()};
  }
  if (region.has("ball")) {
    const Value at = region.member("ball");
    at.object({"centre", "radius"});
    return Ball{at.member("centre").vector(), at.member("radius").number()};
  }
  if (region.has("box")) {
    const Value at = region.member("box");
    at.object({"lower", "upper"});
    return AxisBox{at.member("lower").vector(), at.member("upper").vector()};
  }
  if (region.has("capsule")) {
    const Value at = region.member("capsule");
    at.object({"from", "to", "radius"});
    return Capsule{at.member("from").vector(), at.member("to").vector(), at.member("radius").number()};
  }
  const Value at = region.member("points");
  at.array();
  PointSet points;
  constexpr std::int64_t kLast = (std::int64_t{1} << 31) - 2;
  for (std::size_t i = 0; i < at.size(); ++i) points.points.push_back(at.at(i).whole_number(0, kLast));
  return points;
}

RigidMotion parse_rigid(const Value& rigid) {
  rigid.object({"axis", "point", "degrees", "translation"});
  RigidMotion motion;
  if (rigid.has("axis")) motion.axis = rigid.member("axis").vector();
  if (rigid.has("point")) motion.point = rigid.member("point").vector();
  if (rigid.has("degrees")) motion.angle = rigid.member("degrees").number() * std::numbers::pi / 180;
  if (rigid.has("translation")) motion.translation = rigid.member("translation").vector();
  return motion;
}

AffineMap parse_affine(const Value& affine) {
  affine.object({"matrix", "pivot"});
  AffineMap map;
  const Value rows = affine.member("matrix");
  rows.array(3);
  for (std::size_t row = 0; row < 3; ++row) {
    rows.at(row).array(4);
    for (std::size_t column = 0; column < 4; ++column) map.matrix[4 * row + column] = rows.at(row).at(column).number();
  }
  if (affine.has("pivot")) map.pivot = affine.member("pivot").vector();
  return map;
}

Handle parse_handle(const Value& value) {
  value.object({"region", "rigid", "affine"});
  Handle handle;
  handle.region = parse_region(value.member("region"));
  if (value.has("rigid") && value.has("affine")) value.refuse("must not have both rigid and affine");
  if (value.has("rigid")) handle.transform = parse_rigid(value.member("rigid"));
  if (value.has("affine")) handle.transform = parse_affine(value.member("affine"));
  return handle;
}

void parse_block(const Value& value, Lattice& lattice) {
  if (value.has("box")) {
    if (value.has("origin") || value.has("axes")) value.refuse("must not have both box and origin or axes");
    const Value box = value.member("box");
    box.object({"lower", "upper"});
    lattice.origin = box.member("lower").vector();
    const Vec3d upper = box.member("upper").vector();
    for (std::size_t a = 0; a < 3; ++a) {
      if (!(upper[a] > lattice.origin[a])) box.refuse("lower must be below upper along every axis");
      lattice.axes[a] = {};
      lattice.axes[a][a] = upper[a] - lattice.origin[a];
    }
    return;
  }
  lattice.origin = value.member("origin").vector();
  const Value axes = value.member("axes");
  axes.array(3);
  for (std::size_t a = 0; a < 3; ++a) lattice.axes[a] = axes.at(a).vector();
}

void parse_moves(const Value& moves, Lattice& lattice) {
  moves.array();
  for (std::size_t m = 0; m < moves.size(); ++m) {
    const Value move = moves.at(m);
    move.object({"at", "by"});
    const Value at = move.member("at");
    at.array(3);
    std::array<int, 3> index{};
    for (std::size_t a = 0; a < 3; ++a) index[a] = static_cast<int>(at.at(a).whole_number(0, lattice.spans[a]));
    const Vec3d by = move.member("by").vector();
    Vec3d& point = lattice.control[lattice.index(index[0], index[1], index[2])];
    for (std::size_t a = 0; a < 3; ++a) point[a] += by[a];
  }
}

Lattice parse_lattice(const Value& value) {
  value.object({"box", "origin", "axes", "spans", "control", "moves", "outside"});
  Lattice lattice;
  parse_block(value, lattice);
  const Value spans = value.member("spans");
  spans.array(3);
  constexpr std::int64_t kMostSpans = 15;
  for (std::size_t a = 0; a < 3; ++a) lattice.spans[a] = static_cast<int>(spans.at(a).whole_number(1, kMostSpans));
  lattice.reset();
  if (value.has("control")) {
    const Value control = value.member("control");
    control.array(lattice.control.size());
    for (std::size_t i = 0; i < control.size(); ++i) lattice.control[i] = control.at(i).vector();
  }
  if (value.has("moves")) parse_moves(value.member("moves"), lattice);
  if (value.has("outside") && value.member("outside").one_of({"extend", "stay"}) == "stay")
    lattice.outside = Lattice::Outside::stay;
  return lattice;
}

std::string read_all(const std::string& path) {
  if (path == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad())
    throw Error(ErrorCode::invalid_input, fmt::format("{}: cannot be read; is the name right?", path));
  return text;
}

}  // namespace

Deformation parse_deformation(const std::string& text, const std::string& name) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: is not JSON: byte {}", name, error.byte));
  } catch (const Json::out_of_range&) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: holds a number that is too large", name));
  }
  const Value script(json, name);
  script.object({"handles", "lattices"});
  Deformation deformation;
  if (script.has("handles")) {
    const Value handles = script.member("handles");
    handles.array();
    for (std::size_t i = 0; i < handles.size(); ++i) deformation.handles.push_back(parse_handle(handles.at(i)));
  }
  if (script.has("lattices")) {
    const Value lattices = script.member("lattices");
    lattices.array();
    for (std::size_t i = 0; i < lattices.size(); ++i) deformation.lattices.push_back(parse_lattice(lattices.at(i)));
  }
  return deformation;
}

Deformation read_deformation(const std::string& path) { return parse_deformation(read_all(path), path); }

}  // namespace pointskin::cli
