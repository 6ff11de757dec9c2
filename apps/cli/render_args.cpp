#include "render_args.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "commands.hpp"

namespace pointskin::cli {
namespace {

[[noreturn]] void refuse(const std::string& story) { throw Error(ErrorCode::usage, story); }

/// Reads "1200x900" into `options`.
void parse_size(const std::string& text, RenderOptions& options) {
  const std::size_t x = text.find('x');
  const double width = parse_number(text.substr(0, x)).value_or(0);
  const double height = x == std::string::npos ? 0 : parse_number(text.substr(x + 1)).value_or(0);
  constexpr double kMost = 16384;
  const auto good = [](double pixels) { return pixels >= 1 && pixels <= kMost && pixels == static_cast<int>(pixels); };
  if (!good(width) || !good(height))
    refuse(fmt::format("--size: '{}' is not like 1200x900, each side in [1, {}]", text, kMost));
  options.width = static_cast<int>(width);
  options.height = static_cast<int>(height);
}

/// Exactly `count` finite numbers with commas between them, or none.
std::vector<double> parse_numbers(const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const std::optional<double> value = parse_number(text.substr(from, comma - from));
    if (!value || !std::isfinite(*value)) return {};
    numbers.push_back(*value);
    from = comma + 1;
  }
  return numbers.size() == count ? numbers : std::vector<double>{};
}

Vec3d parse_target(const std::string& text) {
  const std::vector<double> numbers = parse_numbers(text, 3);
  if (numbers.empty()) refuse(fmt::format("--target: '{}' is not like x,y,z", text));
  return {numbers[0], numbers[1], numbers[2]};
}

ValueRange parse_range(const std::string& text) {
  const std::vector<double> numbers = parse_numbers(text, 2);
  if (numbers.empty() || !(numbers[0] < numbers[1]))
    refuse(fmt::format("--range: '{}' is not like LOW,HIGH with LOW below HIGH", text));
  return {numbers[0], numbers[1]};
}

void check_numbers(const RenderArgs& args) {
  const RenderOptions& options = args.options;
  if (!std::isfinite(options.azimuth_degrees)) refuse("--azimuth: is no angle");
  if (!(options.elevation_degrees >= -90 && options.elevation_degrees <= 90))
    refuse(fmt::format("--elevation: {} is not in [-90, 90] degrees", options.elevation_degrees));
  if (!(options.zoom > 0 && options.zoom <= 1000)) refuse(fmt::format("--zoom: {} is not in (0, 1000]", options.zoom));
  if (args.field_of_view && !(*args.field_of_view >= 1 && *args.field_of_view <= 170))
    refuse(fmt::format("--fov: {} is not in [1, 170] degrees", *args.field_of_view));
  if (!(options.point_size >= 0 && options.point_size <= 1000))
    refuse(fmt::format("--point-size: {} is not in [0, 1000] pixels", options.point_size));
  if (options.colour_by.empty() && !args.range.empty()) refuse("--range: needs --colour-by, whose values it is for");
}

ColourMap colour_map_of(const std::string& name) {
  if (name == "auto") return ColourMap::automatic;
  return name == "diverging" ? ColourMap::diverging : ColourMap::sequential;
}

void define_files(CLI::App& command, RenderArgs& args) {
  const std::string group = "Files";
  command.add_option("IN", args.input, "mesh or cloud, or frame_{}.ply for a sequence; - reads stdin")->required();
  command.add_option("-o,--output", args.picture, "picture, .png; {} where IN has it")
      ->type_name("OUT")
      ->group(group)
      ->required();
  add_overwrite_option(command, args.overwrite);
  command.add_option("--first", args.first, "number of the first frame of a sequence")->type_name("N")->group(group);
  command.add_option("--last", args.last, "number of the last frame of a sequence")->type_name("N")->group(group);
}

void define_view(CLI::App& command, RenderArgs& args) {
  const std::string group = "View";
  const auto value = [&](const char* name, auto& target, const char* type, const char* description) {
    return command.add_option(name, target, description)->type_name(type)->group(group);
  };
  RenderOptions& options = args.options;
  value("--size", args.size, "WxH", "width and height in pixels, each 1 to 16384")->capture_default_str();
  value("--up", args.up, "AXIS",
        "axis that points up: x, y, z, -x, -y or -z;\n"
        "the front is +z (y, x, -x), -y (z), -z (-y) or +y (-z)")
      ->capture_default_str();
  value("--azimuth", options.azimuth_degrees, "DEG", "camera about the up axis, degrees; 0 sees the front")
      ->capture_default_str();
  value("--elevation", options.elevation_degrees, "DEG", "camera above the horizon, degrees, -90 to 90")
      ->capture_default_str();
  value("--target", args.target, "X,Y,Z", "point in the middle of the picture [default the middle of what is seen]");
  value("--fit", args.fit, "WHAT",
        "what fills the picture: box (what is seen, as large as can be)\n"
        "or sphere (around all, the same size from every side)")
      ->check(CLI::IsMember({"box", "sphere"}))
      ->capture_default_str();
  value("--zoom", options.zoom, "F", "enlarges the picture about its middle, above 0 to 1000")->capture_default_str();
  value("--fov", args.field_of_view, "DEG",
        "vertical field of view, 1 to 170 degrees [default 30.3 of the shorter side]");
  command.add_flag("--orthographic", args.orthographic, "parallel instead of perspective projection")->group(group);
}

void define_surface(CLI::App& command, RenderArgs& args) {
  const std::string group = "Surface";
  command.add_flag("--wireframe", args.options.wireframe, "draw the edges of a mesh, hidden ones removed")
      ->group(group);
  command.add_flag("--flat", args.flat, "shade a mesh by faces, a cloud without its normals")->group(group);
  command
      .add_flag("--cull", args.cull,
                "leave out what is seen from behind, which is drawn red:\n"
                "an open surface from its other side, or normals turned inwards")
      ->group(group);
  command
      .add_option("--point-size", args.options.point_size,
                  "diameter of a cloud's points in pixels [default by their spacing]")
      ->type_name("PX")
      ->group(group);
  command.add_flag("--no-shadows", args.no_shadows, "no shadows, and all light in hollows")->group(group);
}

void define_colours(CLI::App& command, RenderArgs& args) {
  const std::string group = "Colours";
  const auto value = [&](const char* name, auto& target, const char* type, const char* description) {
    return command.add_option(name, target, description)->type_name(type)->group(group);
  };
  value("--colour-by,--color-by", args.options.colour_by, "NAME",
        "colours by an attribute, or by x, y or z, with a scale");
  value("--range", args.range, "LOW,HIGH", "values of the scale's ends [default the 1st and 99th percentiles]");
  value("--colour-map,--color-map", args.colour_map, "MAP",
        "sequential, diverging (from 0 both ways), or auto: diverging\n"
        "for ranges on both sides of 0")
      ->check(CLI::IsMember({"auto", "sequential", "diverging"}))
      ->capture_default_str();
  command.add_flag("--no-colour-bar,--no-color-bar", args.no_bar, "leave the scale out")->group(group);
  command.add_flag("--no-colours,--no-colors", args.no_colours, "ignore red, green and blue")->group(group);
}

}  // namespace

UpAxis parse_up(const std::string& text, const char* option) {
  const bool minus = text.starts_with('-');
  const std::string axis = minus || text.starts_with('+') ? text.substr(1) : text;
  if (axis == "x") return minus ? UpAxis::minus_x : UpAxis::x;
  if (axis == "y") return minus ? UpAxis::minus_y : UpAxis::y;
  if (axis == "z") return minus ? UpAxis::minus_z : UpAxis::z;
  refuse(fmt::format("{}: '{}' is not x, y, z, -x, -y or -z", option, text));
}

void define_render_options(CLI::App& command, RenderArgs& args) {
  define_files(command, args);
  define_view(command, args);
  define_surface(command, args);
  define_colours(command, args);
  add_threads_option(command, args.options.threads, "Limits");
  command.add_flag("-q,--quiet", args.quiet, "errors and warnings only")->group("Messages");
}

RenderOptions library_options(const RenderArgs& args) {
  RenderOptions options = args.options;
  check_threads(options.threads);
  check_numbers(args);
  parse_size(args.size, options);
  options.up = parse_up(args.up, "--up");
  if (!args.target.empty()) options.target_world = parse_target(args.target);
  if (!args.range.empty()) options.range = parse_range(args.range);
  options.projection = args.orthographic ? Projection::orthographic : Projection::perspective;
  options.fit = args.fit == "sphere" ? Fit::sphere : Fit::box;
  options.field_of_view_degrees = args.field_of_view;
  options.smooth = !args.flat;
  options.back_faces = !args.cull;
  options.colours = !args.no_colours;
  options.shadows = !args.no_shadows;
  options.colour_map = colour_map_of(args.colour_map);
  options.colour_bar = !args.no_bar;
  return options;
}

}  // namespace pointskin::cli
