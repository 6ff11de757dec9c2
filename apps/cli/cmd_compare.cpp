// pointskin compare: how far apart two surfaces are, meshes or clouds, and where.
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "fit_args.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "signals.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;
using Content = std::variant<Cloud, Mesh>;

struct CompareArgs {
  std::string a, b, heat;
  CompareOptions options;
  bool json = false;
  bool with_sign = false, overwrite = false;
};

/// Both files and what was found between them.
struct Comparison {
  Content a, b;
  MeshComparison result;
};

ComparedSurface surface_of(const Content& content) {
  if (const auto* mesh = std::get_if<Mesh>(&content)) return *mesh;
  return std::get<Cloud>(content);
}

Json distances_json(const DistanceStatistics& d, double diagonal) {
  const double to_percent = 100 / diagonal;
  return {{"mean", d.mean},
          {"rms", d.rms},
          {"p95", d.p95},
          {"max", d.max},
          {"mean_percent", d.mean * to_percent},
          {"rms_percent", d.rms * to_percent},
          {"p95_percent", d.p95 * to_percent},
          {"max_percent", d.max * to_percent}};
}

Json side_json(const std::string& file, const Content& content, std::int64_t samples) {
  Json json = {{"file", file}};
  if (const auto* mesh = std::get_if<Mesh>(&content)) {
    json.update({{"kind", "mesh"}, {"vertices", mesh->vertices.size()}, {"triangles", mesh->triangles.size()}});
  } else {
    const auto& cloud = std::get<Cloud>(content);
    json.update({{"kind", "cloud"}, {"points", cloud.size()}, {"normals", cloud.has_normals()}});
  }
  json["samples"] = samples;
  return json;
}

Json compare_json(const CompareArgs& args, const Comparison& comparison) {
  const MeshComparison& c = comparison.result;
  Json json = {{"version", 1},
               {"command", "compare"},
               {"mesh", args.a},
               {"reference", args.b},
               {"a", side_json(args.a, comparison.a, c.samples)},
               {"b", side_json(args.b, comparison.b, c.reference_samples)},
               {"samples", args.options.samples},
               {"tau", args.options.tau},
               {"reference_diagonal", c.reference_diagonal},
               {"to_reference", distances_json(c.to_reference, c.reference_diagonal)},
               {"from_reference", distances_json(c.from_reference, c.reference_diagonal)},
               {"two_sided", distances_json(c.two_sided, c.reference_diagonal)}};
  json["normal_consistency"] = c.has_normals ? Json(c.normal_consistency) : Json(nullptr);
  json.update({{"precision", c.precision}, {"recall", c.recall}, {"f_score", c.f_score}});
  return json;
}

std::string side_text(const char* name, const std::string& file, const Content& content, std::int64_t samples) {
  std::string what;
  if (const auto* mesh = std::get_if<Mesh>(&content)) {
    what = fmt::format("mesh, {} triangles, {} samples", mesh->triangles.size(), samples);
  } else {
    const auto& cloud = std::get<Cloud>(content);
    what = fmt::format("cloud, {} points {} normals", cloud.size(), cloud.has_normals() ? "with" : "without");
    if (samples < cloud.size()) what += fmt::format(", {} of them taken", samples);
  }
  return fmt::format("{:<16}{}: {}\n", name, file, what);
}

std::string distances_text(const char* name, const DistanceStatistics& d, double diagonal) {
  const auto cell = [diagonal](double distance) {
    return fmt::format("{:>22}", fmt::format("{:.4g} ({:.4f} %)", distance, 100 * distance / diagonal));
  };
  return fmt::format("{:<16}{}{}{}{}\n", name, cell(d.mean), cell(d.rms), cell(d.p95), cell(d.max));
}

std::string human_text(const CompareArgs& args, const Comparison& comparison) {
  const MeshComparison& c = comparison.result;
  std::string text = side_text("A", args.a, comparison.a, c.samples);
  text += side_text("B, reference", args.b, comparison.b, c.reference_samples);
  text += fmt::format("distances in world units (in % of the reference's diagonal, {:.6g})\n", c.reference_diagonal);
  text += fmt::format("{:<16}{:>22}{:>22}{:>22}{:>22}\n", "", "mean", "rms", "p95", "max");
  text += distances_text("to reference", c.to_reference, c.reference_diagonal);
  text += distances_text("from reference", c.from_reference, c.reference_diagonal);
  text += distances_text("two-sided", c.two_sided, c.reference_diagonal);
  text += c.has_normals ? fmt::format("normal consistency  {:.5f}\n", c.normal_consistency)
                        : std::string("normal consistency  none: a cloud has no normals\n");
  return text +
         fmt::format("F-score             {:.5f} (precision {:.5f}, recall {:.5f}; within {:g} of the diagonal)\n",
                     c.f_score, c.precision, c.recall, args.options.tau);
}

/// Everything that can be found wrong before the inputs are opened.
void check(const CompareArgs& args) {
  check_threads(args.options.threads);
  if (args.options.samples < 1) throw_usage("--samples: must be at least 1");
  if (!(args.options.tau > 0)) throw_usage("--tau: must be above 0");
  check_distinct({args.a, args.b}, {{"compare", "-"}, {"--heat", args.heat}}, args.overwrite);
  if (args.with_sign && args.heat.empty()) throw_usage("--signed: changes what --heat writes, which is not given");
  if (args.heat.empty()) return;
  const FormatInfo& full = file_formats().front();  // holds clouds, meshes and their properties
  if (format_of(args.heat) != &full)
    throw_usage(fmt::format("--heat: {} does not end in {}", args.heat, full.extensions.front()));
  check_replaceable(args.heat);
}

Content read_side(const std::string& file, const CompareArgs& args) {
  Content content = read_cloud_or_mesh(file, {.shift = std::nullopt, .threads = args.options.threads});
  const auto* cloud = std::get_if<Cloud>(&content);
  const std::string name = file == "-" ? "stdin" : file;
  if (cloud != nullptr) warn_about_dropped(cloud->dropped, name + ": ");
  if (cloud != nullptr && cloud->positions.empty())
    throw Error(ErrorCode::invalid_input,
                fmt::format("{}: holds no points with finite coordinates of at most 1e38", name));
  return content;
}

/// Sets the attribute `name`, in the place of one that has it already.
void set_attribute(std::vector<Attribute>& attributes, const std::string& name, const std::vector<double>& values) {
  std::erase_if(attributes, [&](const Attribute& attribute) { return attribute.name == name; });
  attributes.push_back({name, std::vector<float>(values.begin(), values.end())});
}

void write_heat(const CompareArgs& args, Comparison& comparison, const std::vector<double>& values) {
  const char* const name = args.with_sign ? "signed_distance" : "distance";
  if (auto* mesh = std::get_if<Mesh>(&comparison.a)) {
    set_attribute(mesh->attributes, name, values);
    write_mesh(args.heat, *mesh, args.options.threads);
  } else {
    auto& cloud = std::get<Cloud>(comparison.a);
    set_attribute(cloud.attributes, name, values);
    write_cloud(args.heat, cloud, args.options.threads);
  }
}

int run(const CompareArgs& args) {
  check(args);
  Content a = read_side(args.a, args);
  Comparison comparison{std::move(a), read_side(args.b, args), {}};
  const ComparedSurface surface = surface_of(comparison.a), reference = surface_of(comparison.b);
  std::vector<double> heat;  // first: a reference without an inside is found before the longer part
  if (!args.heat.empty())
    heat = distances(surface, reference, {.with_sign = args.with_sign, .threads = args.options.threads});
  comparison.result = compare(surface, reference, args.options);
  on_interrupt(OnInterrupt::remember);
  throw_if_interrupted();
  if (!args.heat.empty()) write_heat(args, comparison, heat);
  ignore_interrupts();
  write_stdout(args.json ? json_text(compare_json(args, comparison)) : human_text(args, comparison));
  return 0;
}

constexpr char kCompareFooter[] =
    "Of a mesh, area-uniform samples are measured, and its triangles are what is near; of a cloud, its points are "
    "both:\n"
    "distances to a cloud are not below about half of its spacing. A PLY with faces, an OBJ, STL or OFF is a mesh, "
    "all\n"
    "else a cloud. --heat measures all vertices or points of A, not samples.";

OptionTable compare_options(CompareArgs& args) {
  return {{"Measure",
           {option("A", "mesh or cloud; - reads stdin", &args.a, {}, {.required = true}),
            option("B", "the reference: mesh or cloud", &args.b, {}, {.required = true}),
            option("--tau F", "F-score threshold, as a fraction of B's diagonal", &args.options.tau),
            option("--samples N", "samples of each mesh, points of each cloud at most", &args.options.samples)}},
          {"Output",
           {json_row(args.json),
            option("--heat FILE", "also write A with the property `distance` from B, in world units: .ply", &args.heat),
            option("--signed", "with --heat: `signed_distance` instead, above 0 outside of B, which must be watertight",
                   &args.with_sign)}},
          {"Files", {overwrite_row(args.overwrite)}},
          {"Limits", {threads_row(args.options.threads)}}};
}

}  // namespace

Command compare_command() {
  return make_command({"compare", "Measure how far a mesh or cloud is from a reference, both ways.", kCompareFooter},
                      compare_options, run);
}

}  // namespace pointskin::cli
