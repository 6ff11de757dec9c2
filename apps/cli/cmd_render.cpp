// pointskin render: a picture of a mesh or a cloud, or of every frame of a sequence.
#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/formats.hpp>
#include <pointskin/io.hpp>
#include <pointskin/render.hpp>

#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "input.hpp"
#include "output_check.hpp"
#include "progress.hpp"
#include "render_args.hpp"
#include "scene/frame_files.hpp"
#include "signals.hpp"

namespace pointskin::cli {
namespace {

using CloudOrMesh = std::variant<Cloud, Mesh>;

struct PictureFile {
  scene::FrameFile input;
  std::string output;
};

std::vector<PictureFile> pictures_of(const RenderArgs& args) {
  scene::check_patterns(args.input, args.picture, "-o");
  if (extension_of(args.picture) != ".png") throw_usage(fmt::format("{}: pictures are written as .png", args.picture));
  if (!scene::is_pattern(args.input)) check_replaceable(args.picture);  // before the input is looked for
  std::vector<PictureFile> pictures;
  FilePlan plan{{}, {}, args.overwrite};
  for (const scene::FrameFile& file : scene::find_frames(args.input, args.first, args.last)) {
    pictures.push_back({file, scene::with_number(args.picture, file.number)});
    plan.add_frame(file.path, pictures.back().output, OutputKind::file);
  }
  check_files(plan);
  for (const PictureFile& picture : pictures) check_replaceable(picture.output);
  return pictures;
}

CloudOrMesh read(const std::string& path, const RenderArgs& args) {
  CloudOrMesh what = read_cloud_or_mesh(path, {.shift = std::nullopt, .threads = args.options.threads});
  const std::string name = path == "-" ? "stdin" : path;
  if (const Cloud* cloud = std::get_if<Cloud>(&what)) {
    check_not_empty(*cloud, name);
    if (args.options.wireframe) throw_usage(fmt::format("--wireframe: {} holds points, which have no edges", name));
  } else if (args.options.point_size > 0) {
    throw_usage(fmt::format("--point-size: {} is a mesh; it is for points", name));
  }
  return what;
}

/// What the pictures of a sequence have shown, for warnings.
struct Pictured {
  int pictures = 0, with_backs = 0, empty = 0;
  double most_behind = 0;
  std::int64_t strays = 0, dropped = 0;
  bool points = false;

  void add(const CloudOrMesh& what, const RenderReport& report) {
    const Cloud* cloud = std::get_if<Cloud>(&what);
    // Through a gap between points one sees the back of what is behind them: more of that means nothing.
    const double noticeable = cloud != nullptr ? 0.05 : 0.01;
    ++pictures;
    points = cloud != nullptr;
    if (report.covered == 0) ++empty;
    if (report.behind >= noticeable) ++with_backs;
    most_behind = std::max(most_behind, report.behind);
    strays = std::max(strays, report.strays);
    if (cloud != nullptr) dropped += cloud->dropped;
  }
};

std::string backs_text(const Pictured& shown) {
  const int percent = std::max(1, static_cast<int>(100 * shown.most_behind + 0.5));
  const std::string where =
      shown.pictures > 1 ? fmt::format("in {} of {} pictures, up to {} %", shown.with_backs, shown.pictures, percent)
                         : fmt::format("{} %", percent);
  if (shown.points)
    return where +
           " of what is seen are points turned away from the viewer, drawn red: they are seen from behind, or their "
           "normals point inwards; --cull leaves them out, --flat ignores normals";
  return where +
         " of what is seen is the back of the surface, drawn red: the surface is open, or its normals point inwards; "
         "--cull leaves backs out";
}

void warn(const Pictured& shown) {
  warn_about_dropped(shown.dropped);
  if (shown.strays > 0)
    print_warning(fmt::format("{} stray points far from all others do not count for the camera", shown.strays));
  if (shown.with_backs > 0) print_warning(backs_text(shown));
  if (shown.empty > 0)
    print_warning(shown.pictures > 1
                      ? fmt::format("{} of {} pictures are empty: nothing is in view", shown.empty, shown.pictures)
                      : "the picture is empty: nothing is in view");
}

/// Says which frame was wrong.
template <class F>
auto with_name(const PictureFile& picture, const F& work) {
  try {
    return work();
  } catch (const Error& error) {
    if (picture.input.number.empty() || error.code() == ErrorCode::interrupted) throw;
    const std::string story = error.what();
    if (story.find(picture.input.path) != std::string::npos) throw;
    throw Error(error.code(), fmt::format("{}: {}", picture.input.path, story));
  }
}

/// One camera and one range for all frames, which are read for it once more.
void unite(const std::vector<PictureFile>& pictures, const RenderArgs& args, ProgressLine& line,
           RenderOptions& options) {
  std::optional<WorldBox> box;
  std::optional<ValueRange> range;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    throw_if_interrupted();
    with_name(pictures[i], [&] {
      const CloudOrMesh what = read(pictures[i].input.path, args);
      std::visit(
          [&](const auto& w) {
            if (const auto more = fitted_box(w, options.threads)) {
              if (!box) box = more;
              for (std::size_t a = 0; a < 3; ++a) {
                box->lower[a] = std::min(box->lower[a], more->lower[a]);
                box->upper[a] = std::max(box->upper[a], more->upper[a]);
              }
            }
            if (options.colour_by.empty() || options.range) return;
            const auto more = value_range(w, options.colour_by);
            if (more && !range) range = more;
            if (more) range = {std::min(range->low, more->low), std::max(range->high, more->high)};
          },
          what);
    });
    line.update({"looking", static_cast<double>(i + 1) / static_cast<double>(pictures.size()) / 3});
  }
  options.fit_world = box;
  if (range && range->low < range->high) options.range = range;
}

int run(const RenderArgs& args) {
  RenderOptions options = library_options(args);
  const std::vector<PictureFile> pictures = pictures_of(args);
  const bool sequence = !pictures.front().input.number.empty();
  ProgressLine line(!args.quiet && stderr_is_terminal());
  if (sequence) on_interrupt(OnInterrupt::remember);
  if (sequence) unite(pictures, args, line, options);
  Pictured shown;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    with_name(pictures[i], [&] {
      const CloudOrMesh what = read(pictures[i].input.path, args);
      RenderReport report;
      const Image image = std::visit([&](const auto& w) { return render(w, options, &report); }, what);
      on_interrupt(OnInterrupt::remember);
      throw_if_interrupted();
      write_png(pictures[i].output, image);
      if (sequence) frame_was_written();
      if (options.point_size == 0) options.point_size_world = report.point_size_world;  // the same in all frames
      shown.add(what, report);
    });
    line.update({"frames", 1.0 / 3 + 2.0 / 3 * static_cast<double>(i + 1) / static_cast<double>(pictures.size())});
  }
  line.clear();
  warn(shown);
  if (args.quiet) return 0;
  print_note(fmt::format("{}: {} x {} pixels{}", args.picture, options.width, options.height,
                         sequence ? fmt::format(", {} frames", pictures.size()) : ""));
  return 0;
}

}  // namespace

Command render_command() {
  return make_command({"render", "Draw a picture of a mesh or a cloud."}, render_options, run);
}

}  // namespace pointskin::cli
