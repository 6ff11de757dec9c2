// pointskin convert: a mesh or cloud in another format.
#include <memory>
#include <string>
#include <variant>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "input.hpp"
#include "output_check.hpp"
#include "signals.hpp"
#include "summary_words.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

struct ConvertArgs {
  std::string input, output;
  std::string shift = "auto";
  int threads = 0;
  bool ascii = false, overwrite = false, quiet = false;
  GivenOptions given;
};

std::string write(const ConvertArgs& args, const Mesh& mesh) {
  write_mesh(args.output, mesh, {.ascii = args.ascii, .threads = args.threads});
  if (args.quiet) return "";
  return fmt::format("{} vertices, {} triangles, {}", mesh.vertices.size(), mesh.triangles.size(),
                     shape_words(mesh, args.threads));
}

std::string write(const ConvertArgs& args, const Cloud& cloud) {
  check_cloud_name(args.output, "{} holds a cloud, and clouds are written as {} only", args.input);
  if (cloud.dropped > 0)
    print_warning(fmt::format("{} points were dropped: a coordinate is not finite", cloud.dropped));
  write_cloud(args.output, cloud, {.ascii = args.ascii, .threads = args.threads});
  return fmt::format("{} points", cloud.size());
}

int run(const ConvertArgs& args) {
  check_threads(args.threads);
  const ReadOptions options{.shift = parse_shift(args.shift), .threads = args.threads};
  check_distinct({args.input}, {{"OUT", args.output}}, args.overwrite);
  const FormatInfo* const format = format_of(args.output);
  if (format == nullptr || !format->writes_clouds) check_mesh_output(args.output);
  check_result(args.output);
  warn_about_ascii(args.given, args.output);
  const std::variant<Cloud, Mesh> content = read_cloud_or_mesh(args.input, options);
  on_interrupt(OnInterrupt::remember);
  throw_if_interrupted();
  const std::string written = std::visit([&](const auto& held) { return write(args, held); }, content);
  if (!args.quiet) print_note(file_words(args.output) + written);
  return 0;
}

}  // namespace

void add_convert(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "convert", "Write a mesh in another format, or a cloud as PLY.");
  auto args = std::make_shared<ConvertArgs>();
  command->add_option("IN", args->input, "mesh: PLY, OBJ, STL, OFF; cloud: PLY, XYZ, PTS, ASC, TXT, CSV; - is stdin")
      ->required();
  command->add_option("OUT", args->output, "mesh: .ply, .obj, .stl; cloud: .ply; - writes PLY to stdout")->required();
  command->add_option("--shift", args->shift, "offset subtracted while working: auto, none or x,y,z in world units")
      ->type_name("S")
      ->group("Input")
      ->capture_default_str();
  add_ascii_option(*command, args->ascii);
  add_overwrite_option(*command, args->overwrite);
  add_threads_option(*command, args->threads, "Limits");
  command->add_flag("-q,--quiet", args->quiet, "errors and warnings only")->group("Messages");
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
