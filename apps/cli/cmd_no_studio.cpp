// pointskin studio, of a program that was built without it.
#include "args.hpp"
#include "commands.hpp"
#include "studio_args.hpp"

namespace pointskin::cli {
namespace {

int run(const StudioArgs& /*args*/) {
  throw_usage("this build has no studio; build with -DPOINTSKIN_STUDIO=ON, which says what is missing");
}

}  // namespace

Command studio_command() { return make_command({"studio", kStudioDescription}, studio_options, run); }

}  // namespace pointskin::cli
