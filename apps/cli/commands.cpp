#include "commands.hpp"

namespace pointskin::cli {

std::vector<Command> all_commands() {
  return {reconstruct_command(), edit_command(),    info_command(),   check_command(),   compare_command(),
          convert_command(),     deform_command(),  fluid_command(),  orient_command(),  problems_command(),
          render_command(),      boolean_command(), studio_command(), formats_command(), bench_command()};
}

}  // namespace pointskin::cli
