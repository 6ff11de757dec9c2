#include "poisson_recon.hpp"

#include <fmt/format.h>

#include <pointskin/error.hpp>

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

constexpr std::array<Ignored, kIgnoredOptions> kIgnored = {{
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

void define_ignored_options(CLI::App& command, PoissonReconArgs& args) {
  for (std::size_t i = 0; i < kIgnored.size(); ++i) {
    const Ignored& option = kIgnored[i];
    CLI::Option* const defined = option.has_value ? command.add_option(option.name, args.ignored[i])
                                                  : command.add_flag(option.name, args.ignored[i]);
    defined->description(option.why)->group("");
  }
}

void warn_about_poisson_recon(const GivenOptions& given, const PoissonReconArgs& args) {
  for (const Ignored& option : kIgnored)
    if (given.has(option.name)) print_warning(fmt::format("{} {}", option.name, option.why));
  if (args.data.empty() || args.data == kDataAlone) return;
  if (!parse_number(args.data)) throw Error(ErrorCode::usage, fmt::format("--data: '{}' is no number", args.data));
  print_warning(
      fmt::format("--data: the factor {} has no meaning here; properties are carried as with "
                  "--keep-attributes",
                  args.data));
}

}  // namespace pointskin::cli
