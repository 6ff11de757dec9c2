// pointskin render: a picture of a mesh.
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/render.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "output_check.hpp"
#include "signals.hpp"

namespace pointskin::cli {
namespace {

struct RenderArgs {
  std::string mesh, picture;
  std::string size = "1200x900";
  std::string up = "y";
  std::string target;  ///< empty: the middle of the mesh
  RenderOptions options;
  bool orthographic = false, flat = false, cull = false, no_colours = false, overwrite = false, quiet = false;
};

/// Reads "1200x900" into `options`.
void parse_size(const std::string& text, RenderOptions& options) {
  const std::size_t x = text.find('x');
  const double width = parse_number(text.substr(0, x)).value_or(0);
  const double height = x == std::string::npos ? 0 : parse_number(text.substr(x + 1)).value_or(0);
  constexpr double kMost = 16384;
  const auto good = [](double pixels) { return pixels >= 1 && pixels <= kMost && pixels == static_cast<int>(pixels); };
  if (!good(width) || !good(height)) {
    throw Error(ErrorCode::usage, fmt::format("--size: '{}' is not like 1200x900, each side in [1, {}]", text, kMost));
  }
  options.width = static_cast<int>(width);
  options.height = static_cast<int>(height);
}

/// Reads "x,y,z".
Vec3d parse_target(const std::string& text) {
  Vec3d target{};
  std::size_t from = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t comma = text.find(',', from);
    const std::optional<double> value = parse_number(text.substr(from, comma - from));
    if (!value || !std::isfinite(*value) || (comma == std::string::npos) != (a == 2))
      throw Error(ErrorCode::usage, fmt::format("--target: '{}' is not like x,y,z", text));
    target[a] = *value;
    from = comma + 1;
  }
  return target;
}

RenderOptions library_options(const RenderArgs& args) {
  RenderOptions options = args.options;
  check_threads(options.threads);
  parse_size(args.size, options);
  if (args.up != "y" && args.up != "z") throw Error(ErrorCode::usage, "--up: " + not_one_of(args.up, {"y", "z"}));
  if (!args.target.empty()) options.target_world = parse_target(args.target);
  options.up = args.up == "z" ? UpAxis::z : UpAxis::y;
  options.projection = args.orthographic ? Projection::orthographic : Projection::perspective;
  options.smooth = !args.flat;
  options.back_faces = !args.cull;
  options.colours = !args.no_colours;
  return options;
}

int run(const RenderArgs& args) {
  const RenderOptions options = library_options(args);
  if (!has_extension(args.picture, ".png")) {
    throw Error(ErrorCode::usage, fmt::format("{}: pictures are written as .png", args.picture));
  }
  check_distinct({args.mesh}, {{"-o", args.picture, OutputKind::file}}, args.overwrite);
  check_replaceable(args.picture);
  const Mesh mesh = read_mesh(args.mesh, {.shift = std::nullopt, .threads = options.threads});
  if (mesh.triangles.empty()) throw Error(ErrorCode::empty_result, fmt::format("{}: holds no triangles", args.mesh));
  const Image image = render(mesh, options);
  on_interrupt(OnInterrupt::remember);
  throw_if_interrupted();
  write_png(args.picture, image);
  if (!args.quiet) print_note(fmt::format("{}: {} x {} pixels", args.picture, image.width, image.height));
  return 0;
}

void define_view(CLI::App& command, RenderArgs& args) {
  const std::string group = "View";
  const auto value = [&](const char* name, auto& target, const char* type, const char* description) {
    command.add_option(name, target, description)->type_name(type)->group(group)->capture_default_str();
  };
  value("--size", args.size, "WxH", "width and height in pixels, each 1 to 16384");
  value("--azimuth", args.options.azimuth_degrees, "DEG", "camera about the up axis, degrees; 0 sees the front");
  value("--elevation", args.options.elevation_degrees, "DEG", "camera above the horizon, degrees, -90 to 90");
  command.add_option("--target", args.target, "point in the middle of the picture [default the middle of the mesh]")
      ->type_name("X,Y,Z")
      ->group(group);
  value("--up", args.up, "AXIS", "axis that points up: y (front is +z) or z (front is -y)");
  command.add_flag("--orthographic", args.orthographic, "parallel instead of perspective projection")->group(group);
  command.add_flag("--flat", args.flat, "shade by faces even if the mesh has vertex normals")->group(group);
  command.add_flag("--cull", args.cull, "leave out triangles that are seen from behind")->group(group);
  command.add_flag("--no-colours", args.no_colours, "ignore red, green and blue of the mesh")->group(group);
}

}  // namespace

void add_render(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "render", "Draw a picture of a mesh.");
  auto args = std::make_shared<RenderArgs>();
  command->add_option("MESH", args->mesh, "mesh: PLY, OBJ, STL or OFF; - reads PLY from stdin")->required();
  command->add_option("-o,--output", args->picture, "picture, .png")->type_name("OUT")->group("Files")->required();
  add_overwrite_option(*command, args->overwrite);
  define_view(*command, *args);
  add_threads_option(*command, args->options.threads, "Limits");
  command->add_flag("-q,--quiet", args->quiet, "errors and warnings only")->group("Messages");
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
