// pointskin info: what a file holds.
#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "fit_args.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "scene/spacing.hpp"
#include "scene/vector_json.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArgs {
  std::string file;
  std::string shift = "auto";
  int threads = 0;
  bool json = false;
};

Json attributes_json(const std::vector<Attribute>& attributes) {
  Json list = Json::array();
  for (const Attribute& a : attributes) list.push_back({{"name", a.name}, {"type", name_of(a.type())}});
  return list;
}

Json world(const Vec3f& p, const Vec3d& origin) { return {origin[0] + p.x, origin[1] + p.y, origin[2] + p.z}; }

/// What a cloud and the vertices of a mesh have in common.
Json points_json(const std::vector<Vec3f>& positions, const Vec3d& origin, const std::vector<Attribute>& attributes) {
  const Bounds box = bounds_of(positions);
  Json json = Json::object();
  json["bounds"] = {{"lower", world(box.lower, origin)}, {"upper", world(box.upper, origin)}};
  json["origin"] = origin;
  json["attributes"] = attributes_json(attributes);
  json["spacing"] = scene::median_spacing(positions);
  return json;
}

Json strays_json(const Cloud& cloud) {
  constexpr std::size_t kListed = 10;
  const std::vector<std::int64_t> strays = find_strays(cloud.positions).points;
  Json places = Json::array();
  for (std::size_t i = 0; i < std::min(kListed, strays.size()); ++i)
    places.push_back(world(cloud.positions[static_cast<std::size_t>(strays[i])], cloud.origin));
  return {{"count", strays.size()}, {"points", places}};
}

/// What depth the points support; null where they are at one place.
Json suggestion_json(const Cloud& cloud, int threads) {
  try {
    const DepthSuggestion suggested = suggest_depth(cloud, {}, Device::cpu(threads));
    return {{"depth", suggested.depth},
            {"supported", suggested.supported},
            {"spacing", suggested.spacing},
            {"noise", suggested.noise}};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::empty_result) throw;
    return nullptr;
  }
}

Json describe(const Cloud& cloud, int threads) {
  Json json = {{"kind", "cloud"}, {"points", cloud.size()}, {"dropped", cloud.dropped}};
  json["normals"] = cloud.has_normals();
  json["strays"] = strays_json(cloud);
  json.update(points_json(cloud.positions, cloud.origin, cloud.attributes));
  json["suggestion"] = suggestion_json(cloud, threads);
  return json;
}

Json describe(const Mesh& mesh, int /*threads*/) {
  Json json = {{"kind", "mesh"}, {"vertices", mesh.vertices.size()}, {"triangles", mesh.triangles.size()}};
  json["normals"] = !mesh.normals.empty();
  json.update(points_json(mesh.vertices, mesh.origin, mesh.attributes));
  return json;
}

std::string vector_text(const Json& v) {
  return fmt::format("{:.9g} {:.9g} {:.9g}", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

std::string attributes_text(const Json& attributes) {
  std::string text;
  for (const Json& a : attributes) {
    text +=
        fmt::format("{}{} ({})", text.empty() ? "" : ", ", a["name"].get<std::string>(), a["type"].get<std::string>());
  }
  return text.empty() ? "none" : text;
}

std::string human_text(const Json& json) {
  std::string text;
  const auto line = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<12}{}\n", name, value);
  };
  line("file", json["file"].get<std::string>());
  line("kind", json["kind"].get<std::string>());
  for (const char* count : {"points", "dropped", "vertices", "triangles"}) {
    if (json.contains(count)) line(count, std::to_string(json[count].get<std::int64_t>()));
  }
  line("normals", json["normals"].get<bool>() ? "yes" : "no");
  line("attributes", attributes_text(json["attributes"]));
  line("lower", vector_text(json["bounds"]["lower"]));
  line("upper", vector_text(json["bounds"]["upper"]));
  line("origin", vector_text(json["origin"]));
  if (json.contains("strays") && json["strays"]["count"].get<std::int64_t>() > 0)
    line("strays", fmt::format("{}, the farthest at {}", json["strays"]["count"].get<std::int64_t>(),
                               vector_text(json["strays"]["points"][0])));
  line("spacing", fmt::format("{:.4g}", json["spacing"].get<double>()));
  if (json.contains("suggestion") && !json["suggestion"].is_null()) {
    const Json& suggested = json["suggestion"];
    line("depth", fmt::format("{} suits (surface points {:.3g} apart, noise {:.3g})", suggested["depth"].get<int>(),
                              suggested["spacing"].get<double>(), suggested["noise"].get<double>()));
  }
  return text;
}

int run(const InfoArgs& args) {
  check_threads(args.threads);
  const ReadOptions options{.shift = parse_shift(args.shift), .threads = args.threads};
  const std::variant<Cloud, Mesh> content = read_cloud_or_mesh(args.file, options);
  Json json = {{"version", 1}, {"command", "info"}, {"file", args.file}};
  json.update(std::visit([&args](const auto& held) { return describe(held, args.threads); }, content));
  write_stdout(args.json ? json_text(json) : human_text(json));
  return 0;
}

constexpr char kInfoFooter[] =
    "Prints counts, normals, attributes and their types, the bounding box in world coordinates, the origin that was\n"
    "subtracted while reading, stray points far from all others (`reconstruct` leaves them out), the spacing (the "
    "median\n"
    "distance to the nearest neighbour, in world units), and the depth that suits `reconstruct`: from the spacing of\n"
    "points along the surface, their noise across it, and the memory of this machine.";

OptionTable info_options(InfoArgs& args) {
  return {{"Output",
           {option("FILE", "cloud or mesh; - reads stdin", &args.file, {}, {.required = true}), json_row(args.json)}},
          {"Input", {shift_row(args.shift, "on reading")}},
          {"Limits", {threads_row(args.threads)}}};
}

}  // namespace

Command info_command() {
  return make_command({"info", "Print what a cloud or mesh file holds.", kInfoFooter}, info_options, run);
}

}  // namespace pointskin::cli
