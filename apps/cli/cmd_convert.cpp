// pointskin convert: a mesh or cloud in another format.
#include <string>
#include <variant>

#include <fmt/format.h>

#include <pointskin/formats.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "fit_args.hpp"
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
  bool ascii = false, wide = false, compress = false, overwrite = false, quiet = false;
  GivenOptions given;
};

WriteOptions write_options(const ConvertArgs& args) {
  return {.ascii = args.ascii, .threads = args.threads, .double_coordinates = args.wide, .compress = args.compress};
}

std::string write_content(const ConvertArgs& args, const Mesh& mesh) {
  write_mesh(args.output, mesh, write_options(args));
  ignore_interrupts();
  if (args.quiet) return "";
  return fmt::format("{} vertices, {} triangles, {}", mesh.vertices.size(), mesh.triangles.size(),
                     shape_words(mesh, args.threads));
}

std::string write_content(const ConvertArgs& args, const Cloud& cloud) {
  check_cloud_name(args.output, "{} holds a cloud, and clouds are written as {} only", args.input);
  warn_about_dropped(cloud.dropped);
  write_cloud(args.output, cloud, write_options(args));
  ignore_interrupts();
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
  if (format != nullptr && format->name != "PLY") warn_unused(args.given, {"--double"}, "in files other than PLY");
  if (format != nullptr && format->name != "GLB") warn_unused(args.given, {"--compress"}, "in files other than GLB");
  const std::variant<Cloud, Mesh> content = read_cloud_or_mesh(args.input, options);
  on_interrupt(OnInterrupt::remember);
  throw_if_interrupted();
  const std::string written = std::visit([&](const auto& held) { return write_content(args, held); }, content);
  if (!args.quiet) print_note(file_words(args.output) + written);
  return 0;
}

OptionTable convert_options(ConvertArgs& args) {
  return {{"Input",
           {option("IN", "mesh or cloud: " + format_names(&FormatInfo::reads_clouds) + "; - is stdin", &args.input, {},
                   {.required = true}),
            option("OUT",
                   "mesh: " + extension_list(&FormatInfo::writes_meshes) +
                       "; cloud: " + extension_list(&FormatInfo::writes_clouds) + "; - is stdout",
                   &args.output, {}, {.required = true}),
            shift_row(args.shift)}},
          {"Files",
           {ascii_row(args.ascii),
            option("--double", "write coordinates of PLY as double also where float holds them", &args.wide),
            option("--compress", "write GLB a quarter as large, with positions of 16 bits and normals of 12",
                   &args.compress),
            overwrite_row(args.overwrite)}},
          {"Limits", {threads_row(args.threads)}},
          quiet_option(args.quiet)};
}

}  // namespace

Command convert_command() {
  return make_command({"convert", "Write a mesh in another format, or a cloud as PLY."}, convert_options, run);
}

}  // namespace pointskin::cli
