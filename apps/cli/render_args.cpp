#include "render_args.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "args.hpp"
#include "fit_args.hpp"

namespace pointskin::cli {
namespace {

/// Reads "1200x900" into `options`.
void parse_size(const std::string& text, RenderOptions& options) {
  const std::size_t x = text.find('x');
  const double width = parse_number(text.substr(0, x)).value_or(0);
  const double height = x == std::string::npos ? 0 : parse_number(text.substr(x + 1)).value_or(0);
  constexpr double kMost = 16384;
  const auto good = [](double pixels) { return pixels >= 1 && pixels <= kMost && pixels == static_cast<int>(pixels); };
  if (!good(width) || !good(height))
    throw_usage(fmt::format("--size: '{}' is not like 1200x900, each side in [1, {}]", text, kMost));
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
  if (numbers.empty()) throw_usage(fmt::format("--target: '{}' is not like x,y,z", text));
  return {numbers[0], numbers[1], numbers[2]};
}

ValueRange parse_range(const std::string& text) {
  const std::vector<double> numbers = parse_numbers(text, 2);
  if (numbers.empty() || !(numbers[0] < numbers[1]))
    throw_usage(fmt::format("--range: '{}' is not like LOW,HIGH with LOW below HIGH", text));
  return {numbers[0], numbers[1]};
}

void check_numbers(const RenderArgs& args) {
  const RenderOptions& options = args.options;
  if (!std::isfinite(options.azimuth_degrees)) throw_usage("--azimuth: is no angle");
  if (!(options.elevation_degrees >= -90 && options.elevation_degrees <= 90))
    throw_usage(fmt::format("--elevation: {} is not in [-90, 90] degrees", options.elevation_degrees));
  if (!(options.zoom > 0 && options.zoom <= 1000))
    throw_usage(fmt::format("--zoom: {} is not in (0, 1000]", options.zoom));
  if (options.field_of_view_degrees && !(*options.field_of_view_degrees >= 1 && *options.field_of_view_degrees <= 170))
    throw_usage(fmt::format("--fov: {} is not in [1, 170] degrees", *options.field_of_view_degrees));
  if (!(options.point_size >= 0 && options.point_size <= 1000))
    throw_usage(fmt::format("--point-size: {} is not in [0, 1000] pixels", options.point_size));
  if (options.colour_by.empty() && !args.range.empty())
    throw_usage("--range: needs --colour-by, whose values it is for");
}

OptionGroup file_options(RenderArgs& args) {
  return {"Files",
          {option("IN", "mesh or cloud, or frame_{}.ply for a sequence; - reads stdin", &args.input, {},
                  {.required = true}),
           option("-o,--output OUT", "picture, .png; {} where IN has it", &args.picture, {}, {.required = true}),
           overwrite_row(args.overwrite), option("--first N", "number of the first frame of a sequence", &args.first),
           option("--last N", "number of the last frame of a sequence", &args.last)}};
}

OptionGroup view_options(RenderArgs& args) {
  RenderOptions& o = args.options;
  return {"View",
          {option("--size WxH", "width and height in pixels, each 1 to 16384", &args.size),
           option("--up AXIS",
                  "axis that points up: x, y, z, -x, -y or -z;\n"
                  "the front is +z (y, x, -x), -y (z), -z (-y) or +y (-z)",
                  &args.up),
           option("--azimuth DEG", "camera about the up axis, degrees; 0 sees the front", &o.azimuth_degrees),
           option("--elevation DEG", "camera above the horizon, degrees, -90 to 90", &o.elevation_degrees),
           option("--target X,Y,Z", "point in the middle of the picture [default the middle of what is seen]",
                  &args.target),
           option("--fit WHAT",
                  "what fills the picture: box (what is seen, as large as can be)\n"
                  "or sphere (around all, the same size from every side)",
                  one_of<Fit>(o.fit, {{"box", Fit::box}, {"sphere", Fit::sphere}})),
           option("--zoom F", "enlarges the picture about its middle, above 0 to 1000", &o.zoom),
           option("--fov DEG", "vertical field of view, 1 to 170 degrees [default 30.3 of the shorter side]",
                  &o.field_of_view_degrees),
           option("--orthographic", "parallel instead of perspective projection",
                  turned(o.projection, Projection::orthographic))}};
}

OptionGroup surface_options(RenderOptions& o) {
  return {"Surface",
          {option("--wireframe", "draw the edges of a mesh, hidden ones removed", &o.wireframe),
           option("--flat", "shade a mesh by faces, a cloud without its normals", negated(o.smooth)),
           option("--cull",
                  "leave out what is seen from behind, which is drawn red:\n"
                  "an open surface from its other side, or normals turned inwards",
                  negated(o.back_faces)),
           option("--point-size PX", "diameter of a cloud's points in pixels [default by their spacing]", &o.point_size,
                  {}, {.no_default = true}),
           option("--no-shadows", "no shadows, and all light in hollows", negated(o.shadows))}};
}

OptionGroup colour_options(RenderArgs& args) {
  RenderOptions& o = args.options;
  return {
      "Colours",
      {option("--colour-by,--color-by NAME", "colours by an attribute, or by x, y or z, with a scale", &o.colour_by),
       option("--range LOW,HIGH", "values of the scale's ends [default the 1st and 99th percentiles]", &args.range),
       option("--colour-map,--color-map MAP",
              "sequential, diverging (from 0 both ways), or auto: diverging\n"
              "for ranges on both sides of 0",
              one_of<ColourMap>(o.colour_map, {{"auto", ColourMap::automatic},
                                               {"sequential", ColourMap::sequential},
                                               {"diverging", ColourMap::diverging}})),
       option("--no-colour-bar,--no-color-bar", "leave the scale out", negated(o.colour_bar)),
       option("--no-colours,--no-colors", "ignore red, green and blue", negated(o.colours))}};
}

}  // namespace

UpAxis parse_up(const std::string& text, const char* option) {
  const bool minus = text.starts_with('-');
  const std::string axis = minus || text.starts_with('+') ? text.substr(1) : text;
  if (axis == "x") return minus ? UpAxis::minus_x : UpAxis::x;
  if (axis == "y") return minus ? UpAxis::minus_y : UpAxis::y;
  if (axis == "z") return minus ? UpAxis::minus_z : UpAxis::z;
  throw_usage(fmt::format("{}: '{}' is not x, y, z, -x, -y or -z", option, text));
}

OptionTable render_options(RenderArgs& args) {
  return {file_options(args),
          view_options(args),
          surface_options(args.options),
          colour_options(args),
          {"Limits", {threads_row(args.options.threads)}},
          quiet_option(args.quiet)};
}

RenderOptions library_options(const RenderArgs& args) {
  RenderOptions options = args.options;
  check_threads(options.threads);
  check_numbers(args);
  parse_size(args.size, options);
  options.up = parse_up(args.up, "--up");
  if (!args.target.empty()) options.target_world = parse_target(args.target);
  if (!args.range.empty()) options.range = parse_range(args.range);
  return options;
}

}  // namespace pointskin::cli
