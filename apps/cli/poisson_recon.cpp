#include "poisson_recon.hpp"

#include <array>

#include <fmt/format.h>

#include "args.hpp"
#include "console.hpp"

namespace pointskin::cli {
namespace {

struct Ignored {
  const char* name;
  bool has_value;
  const char* why;
};

constexpr char kInside[] = "has no meaning here: it is about the inside of PoissonRecon";

constexpr std::array<Ignored, 22> kIgnored = {{
    {"--alignDir", true, kInside},
    {"--baseDepth", true, kInside},
    {"--baseVCycles", true, kInside},
    {"--cgAccuracy", true, kInside},
    {"--chunkSize", true, kInside},
    {"--degree", true, kInside},
    {"--envelopeDepth", true, kInside},
    {"--exact", false, kInside},
    {"--fullDepth", true, kInside},
    {"--gradients", false, "is the default here: vertices have normals, of unit length"},
    {"--inCore", false, kInside},
    {"--kernelDepth", true, kInside},
    {"--lowDepthCutOff", true, kInside},
    {"--noErode", false, kInside},
    {"--nonManifold", false, "has no meaning here: meshes are always manifold"},
    {"--parallel", true, kInside},
    {"--performance", false, "has no meaning here: times are in the last line, and in --report"},
    {"--polygonMesh", false, "has no meaning here: meshes consist of triangles"},
    {"--primalGrid", false, kInside},
    {"--schedule", true, kInside},
    {"--solveDepth", true, kInside},
    {"--tempDir", true, kInside},
}};

}  // namespace

OptionGroup ignored_options() {
  OptionGroup group;
  for (const Ignored& option : kIgnored) {
    const auto nothing = [](const std::string&) { return std::string(); };
    group.rows.push_back({option.name + std::string(option.has_value ? " TEXT" : ""), option.why,
                          text_for("", nothing, [] { return nullptr; })});
  }
  return group;
}

void warn_about_poisson_recon(const GivenOptions& given, const std::string& data) {
  for (const Ignored& option : kIgnored)
    if (given.has(option.name)) print_warning(fmt::format("{} {}", option.name, option.why));
  if (data.empty() || data == kDataAlone) return;
  if (!parse_number(data)) throw_usage(fmt::format("--data: '{}' is no number", data));
  print_warning(
      fmt::format("--data: the factor {} has no meaning here; properties are carried as with "
                  "--keep-attributes",
                  data));
}

}  // namespace pointskin::cli
