#include "fit_args.hpp"

#include <cmath>

#include <fmt/format.h>
#include <pointskin/formats.hpp>

namespace pointskin::cli {
namespace {

/// PoissonRecon's exponent of the normals' length.
Binding zero_or_one(bool& value) {
  const auto settle = [&value](const std::string& text) {
    const double number = text == "true" ? 1 : text == "false" ? 0 : parse_number(text).value_or(-1);
    value = number == 1;
    return number == 0 || number == 1 ? "" : text + " is not 0 or 1; other exponents are not supported";
  };
  return text_for("0", settle, [&value] { return value; });
}

Binding depth_or_auto(int& depth) {
  const auto settle = [&depth](const std::string& text) {
    const double value = text == "auto" ? Options::kAutomaticDepth : parse_number(text).value_or(-1);
    const bool good = text == "auto" || (value >= 1 && value <= 20 && value == std::floor(value));
    if (good) depth = static_cast<int>(value);
    return good ? "" : fmt::format("'{}' is not a whole number from 1 to 20 or auto", text);
  };
  return text_for(std::to_string(depth), settle, [&depth] { return std::int64_t{depth}; });
}

Binding share_or_auto(double& share) {
  const auto settle = [&share](const std::string& text) {
    const double value = text == "auto" ? Options::kAutomaticTrim : parse_number(text).value_or(-1);
    const bool good = text == "auto" || (value >= 0 && value < 1);
    if (good) share = value;
    return good ? "" : fmt::format("'{}' is not a number from 0 to below 1 or auto", text);
  };
  return text_for(fmt::format("{}", share), settle, [&share] { return share; });
}

/// How a field is solved for.
std::vector<OptionRow> solve_rows(Options& o) {
  return {option("--depth D", "octree depth D in levels, 1 to 20; cells are cube / 2^D wide", depth_or_auto(o.depth),
                 {"depth", 1, kFromOne}),
          option("--screening W", "weight of the points, no unit, >= 0; 0: unscreened", &o.screening,
                 {"screening", 3, kFromZero}),
          option("--iterations N", "relaxations per level, 1 to 1000", &o.iterations, {"iterations", 4, kFromOne}),
          option("--scale F", "working cube / bounding cube of the points, 1 to 100", &o.scale, {"scale", 5, kFromOne}),
          option("--samples-per-node N", "points a cell should hold, 0 to 100", &o.samples_per_node,
                 {"samples_per_node", 6, kFromZero}),
          option("--fixed-screening", "weigh all points alike, however much they scatter", &o.fixed_screening,
                 {"fixed_screening", 8}),
          option("--linear-fit", "place vertices by linear interpolation (also =on, =off)", &o.linear_fit,
                 {"linear_fit", 9}),
          option("--boundary B", "field on the cube's faces: free (also called neumann), or dirichlet: 0",
                 one_of<Boundary>(
                     o.boundary,
                     {{"free", Boundary::free}, {"dirichlet", Boundary::dirichlet}, {"neumann", Boundary::free}}),
                 {"boundary", 15}),
          option("--keep-strays", "use stray points, too, and make the cube for all points", &o.keep_strays,
                 {"keep_strays", 21}),
          option("--no-normals", "leave vertex normals out of the mesh", negated(o.normals), {"normals", 13})};
}

/// What is done with the field then.
std::vector<OptionRow> mesh_rows(FitArgs& args) {
  Options& o = args.options;
  return {
      option("--field F", "poisson (a field solved for), or distance (to the points' tangent planes)",
             one_of<FieldKind>(o.field, {{"poisson", FieldKind::poisson}, {"distance", FieldKind::distance}}),
             {"field", 2}),
      option("--confidence", "the length of a normal is the weight of its point", zero_or_one(o.confidence),
             {"confidence", 7}),
      option("--open", "leave the surface open at the cube's faces, instead of closed",
             turned(o.domain_faces, DomainFaces::open), {"open", 14}),
      option("--envelope MESH", "closed mesh that the surface stays inside of [default none]", &args.envelope,
             {"envelope", 33}, {.check = needs_a_name}),
      option("--offset D", "distance of the mesh from the surface, world units, > 0 outwards", &o.offset,
             {"offset", 16, R"({"description": "world units, > 0 outwards; 0: off"})"}),
      option("--trim Q", "cut where samples end: share that counts as sparse, 0 (off) to below 1",
             share_or_auto(o.trim), {"trim", 17, R"({"minimum": 0, "exclusiveMaximum": 1,
          "description": "0: off, also where auto found nothing to cut"})"}),
      option("--island-ratio R", "trim: smallest piece, share of the area, 0 to below 1", &o.island_ratio,
             {"island_ratio", 18, R"({"minimum": 0, "exclusiveMaximum": 1})"}),
      option("--largest", "keep only the connected piece with the largest area", &o.largest, {"largest", 19}),
      option("--min-component N|RATIO",
             "leave out smaller pieces: triangles, or below 1 the share of the area; 0: none", &o.min_component,
             {"min_component", 20,
              R"({"minimum": 0, "description": "triangles, or below 1 a share of the area; 0: none"})"}),
      option("--density", "add the property density, points per world unit^2", &o.density, {"density", 10}),
      option("--weakness", "add the property weakness, 0 to 1: how doubtful the topology is", &o.weakness,
             {"weakness", 11}),
      option("--keep-attributes", "carry colours and every other property of the points to the vertices", &o.attributes,
             {"attributes", 12}),
      option("", "", &o.max_memory_bytes, {"max_memory_bytes", 22, R"({"minimum": 0, "description": "0: no limit"})"})};
}

}  // namespace

Device DeviceArgs::chosen() const { return parse_device(device, threads); }

std::string needs_a_name(const std::string& file) { return file.empty() ? "needs the name of a file" : ""; }
std::string needs_a_value(const std::string& text) { return text.empty() ? "needs a value" : ""; }

Binding memory_limit(std::int64_t& bytes, const std::string& unit) {
  const auto settle = [&bytes, unit](const std::string& text) {
    const bool unlimited = unit.empty() ? text.empty() : parse_number(text) == 0;
    bytes = unlimited ? 0 : parse_bytes(text + unit, "--max-memory");
    return std::string();
  };
  return text_for("", settle, [&bytes] { return bytes; });
}

OptionGroup device_options(DeviceArgs& args) {
  return {kDeviceGroup,
          {option("--device DEV", "auto, cpu, cuda, cuda:N, cuda:N,M, cuda:all (several GPUs as one)", &args.device,
                  {"device", 30}),
           threads_row(args.threads)}};
}

OptionGroup memory_options(std::int64_t& bytes) {
  return {kDeviceGroup,
          {option("--max-memory SIZE", "memory that the process may take, e.g. 8G [default: most of what is free]",
                  memory_limit(bytes))}};
}

OptionGroup fit_options(FitArgs& args) {
  OptionGroup group = {kSurfaceGroup, solve_rows(args.options)};
  for (OptionRow& row : mesh_rows(args)) group.rows.push_back(std::move(row));
  return group;
}

OptionRow clouds_row(std::vector<std::string>& files, OptionRules rules) {
  return option("IN", "oriented clouds, merged; - reads stdin", &files, {"inputs", 60}, std::move(rules));
}

OptionRow output_row(std::string& file, OptionRules rules) {
  return option("-o,--output OUT", "mesh: " + extension_list(&FormatInfo::writes_meshes) + "; - writes PLY to stdout",
                &file, {"output", 62}, std::move(rules));
}

OptionRow threads_row(int& threads) {
  return option("--threads N", "CPU threads, 0: all that the process may use", &threads,
                {"threads", 31, R"({"minimum": 0, "description": "0: all"})"});
}

OptionRow shift_row(std::string& shift, const std::string& when) {
  return option("--shift S", "offset subtracted " + when + ": auto, none or x,y,z in world units", &shift,
                {"shift", 32});
}

OptionRow ascii_row(bool& ascii) { return option("--ascii", "write PLY as text", &ascii); }

OptionRow overwrite_row(bool& overwrite) {
  return option("--overwrite", "let an output replace an input, once that has been read", &overwrite);
}

OptionRow report_row(std::string& file, const std::string& help) {
  return {"--report FILE", help, &file, {}, {.check = needs_a_name}};
}

OptionRow json_row(bool& json) { return option("--json", "print JSON", &json); }

OptionGroup quiet_option(bool& quiet) {
  return {"Messages", {option("-q,--quiet", "errors and warnings only", &quiet)}};
}

}  // namespace pointskin::cli
