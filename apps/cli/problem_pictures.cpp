#include "problem_pictures.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/render.hpp>

#include "args.hpp"
#include "console.hpp"
#include "output_check.hpp"
#include "progress.hpp"
#include "render_args.hpp"
#include "signals.hpp"

namespace pointskin::cli {
namespace {

namespace fs = std::filesystem;

void make_folder(const std::string& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure || !fs::is_directory(folder, failure))
    throw Error(ErrorCode::output_not_written,
                fmt::format("{}: the folder cannot be made: {}", folder,
                            failure ? failure.message() : "there is a file of this name"));
}

std::string caption_of(const std::vector<ProblemRegion>& regions, std::size_t r, std::size_t v) {
  const ProblemRegion& region = regions[r];
  const ProblemView& view = region.views[v];
  return fmt::format(
      "problem {} of {}, view {} of {}\n"
      "score {:.4g}, weakness up to {:.2f}, {:.0f} % of it in view\n"
      "azimuth {:.1f}, elevation {:.1f}, zoom {:.3g}, target {:.5g},{:.5g},{:.5g}",
      r + 1, regions.size(), v + 1, region.views.size(), region.score, region.peak, 100 * view.visible,
      view.azimuth_degrees, view.elevation_degrees, view.zoom, view.target_world[0], view.target_world[1],
      view.target_world[2]);
}

}  // namespace

OptionGroup problem_options(ProblemPictureArgs& args) {
  return {"Pictures",
          {option("--pictures DIR", "draw the views into this folder, which is made: problem_01_1.png, ...",
                  &args.folder, {"pictures", 52, R"({"description": "of problems: the folder of the pictures"})"}),
           option("--pictures-most N", "regions to draw, the worst first, 1 to 999", &args.most,
                  {"pictures_most", 53, R"({"minimum": 1, "description": "of problems: regions to draw"})"}),
           option("--up AXIS", "axis that points up in the views: x, y, z, -x, -y or -z", &args.up,
                  {"up", 51, R"({"description": "of problems: the axis that points up in the views"})"})}};
}

void check_problem_pictures(const ProblemPictureArgs& args) {
  parse_up(args.up, "--up");
  if (args.most < 1 || args.most > 999) throw_usage(fmt::format("--pictures-most: {} is not in [1, 999]", args.most));
  if (args.folder.empty()) return;
  std::error_code ignored;
  fs::path place = fs::absolute(args.folder, ignored);
  while (!fs::exists(place, ignored) && place.has_parent_path() && place != place.root_path())
    place = place.parent_path();
  if (!fs::is_directory(place, ignored))
    throw Error(ErrorCode::output_not_written,
                fmt::format("{}: pictures need a folder, and {} is none", args.folder, place.string()));
  check_replaceable((place / "problem_01_1.png").string());
}

ProblemOptions problem_options(const ProblemPictureArgs& args, int threads) {
  ProblemOptions options;
  options.up = parse_up(args.up, "--up");
  options.threads = threads;
  return options;
}

std::vector<PictureNames> write_problem_pictures(const Mesh& mesh, const std::vector<ProblemRegion>& regions,
                                                 const ProblemPictureArgs& args, int threads, bool progress) {
  std::vector<PictureNames> names;
  if (args.folder.empty()) return names;
  make_folder(args.folder);
  RenderOptions options;
  options.up = parse_up(args.up, "--up");
  options.threads = threads;
  const std::size_t drawn = std::min(regions.size(), static_cast<std::size_t>(args.most));
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(drawn).size());
  names.resize(regions.size());
  ProgressLine line(progress && stderr_is_terminal());
  for (std::size_t r = 0; r < drawn; ++r)
    for (std::size_t v = 0; v < regions[r].views.size(); ++v) {
      throw_if_interrupted();
      const std::string name = (fs::path(args.folder) / fmt::format("problem_{:0{}}_{}.png", r + 1, digits, v + 1));
      write_png(name, render_problem(mesh, regions[r], v, options, caption_of(regions, r, v)));
      file_was_written();
      names[r].push_back(name);
      line.update({"pictures", (static_cast<double>(r) + static_cast<double>(v + 1) / 3) / static_cast<double>(drawn)});
    }
  return names;
}

}  // namespace pointskin::cli
