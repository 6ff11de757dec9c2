// pointskin render: options that become those of the library, sequences, warnings, and what is refused.
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/render.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

class RenderCommand : public testing::Test {
 protected:
  RenderCommand() {
    Mesh torus = torus_mesh(30, 15);
    std::vector<float> heights;
    for (const Vec3f& v : torus.vertices) heights.push_back(v.y);
    torus.attributes = {{"height", heights}};
    write_mesh(mesh_, torus);
    write_cloud(cloud_, torus_cloud(2'000, 1));
  }

  Result render_file(const std::string& input, const Args& more = {}) {
    Args args = {"render", input, "-o", picture_, "--size", "80x60", "-q"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  /// The bytes of the file that the library draws.
  template <class What>
  std::string expected(const What& what, RenderOptions options = {}) {
    options.width = 80;
    options.height = 60;
    const std::string path = folder_ / "expected.png";
    write_png(path, render(what, options));
    return read_file(path);
  }

  void expect_picture(const Args& more, const RenderOptions& options) {
    const Result result = render_file(mesh_, more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(read_file(picture_) == expected(read_mesh(mesh_), options)) << more[0];
    std::filesystem::remove(picture_);
  }

  void expect_usage_error(const std::string& input, const Args& more, const std::string& part) {
    const Result result = render_file(input, more);
    expect_error(result, 2, part);
    EXPECT_FALSE(std::filesystem::exists(picture_)) << more[0];
  }

  TemporaryFolder folder_;
  std::string mesh_ = folder_ / "torus.ply", cloud_ = folder_ / "cloud.ply", picture_ = folder_ / "out.png";
};

TEST_F(RenderCommand, OptionsAreThoseOfTheLibrary) {
  expect_picture({"--fit", "sphere"}, {.fit = Fit::sphere});
  expect_picture({"--zoom", "2.5"}, {.zoom = 2.5});
  expect_picture({"--fov", "70"}, {.field_of_view_degrees = 70});
  expect_picture({"--wireframe"}, {.wireframe = true});
  expect_picture({"--no-shadows"}, {.shadows = false});
  expect_picture({"--target", "-1,0.5,0"}, {.target_world = Vec3d{-1, 0.5, 0}});
  expect_picture({"--colour-by", "height"}, {.colour_by = "height"});
  expect_picture({"--color-by", "height", "--range", "-1,0.5", "--colour-map", "sequential"},
                 {.colour_by = "height", .range = ValueRange{-1, 0.5}, .colour_map = ColourMap::sequential});
  const std::vector<std::pair<std::string, UpAxis>> axes = {
      {"x", UpAxis::x},  {"y", UpAxis::y},        {"z", UpAxis::z},        {"-x", UpAxis::minus_x},
      {"+x", UpAxis::x}, {"-y", UpAxis::minus_y}, {"-z", UpAxis::minus_z}, {"+z", UpAxis::z}};
  for (const auto& [name, up] : axes) expect_picture({"--up", name}, {.up = up});
}

TEST_F(RenderCommand, DrawsCloudsToo) {
  ASSERT_EQ(render_file(cloud_).exit_code, 0);
  EXPECT_TRUE(read_file(picture_) == expected(read_cloud(cloud_)));
  ASSERT_EQ(render_file(cloud_, {"--point-size", "7"}).exit_code, 0);
  EXPECT_TRUE(read_file(picture_) == expected(read_cloud(cloud_), {.point_size = 7}));
  write_file(folder_ / "one.xyz", "1 2 3\n");
  EXPECT_EQ(render_file(folder_ / "one.xyz").exit_code, 0);
  write_file(folder_ / "vertices.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  EXPECT_EQ(render_file(folder_ / "vertices.obj").exit_code, 0);
  Start start;
  start.args = {"render", "-", "-o", picture_, "--size", "80x60"};
  start.input = read_file(cloud_);
  EXPECT_EQ(run_program(start).exit_code, 0);
  EXPECT_TRUE(read_file(picture_) == expected(read_cloud(cloud_)));
}

TEST_F(RenderCommand, WithoutPointsIsAnEmptyResult) {
  write_file(folder_ / "empty.ply",
             "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
             "property float z\nend_header\n");
  expect_error(render_file(folder_ / "empty.ply"), 5, "no points");
  EXPECT_FALSE(std::filesystem::exists(picture_));
}

TEST_F(RenderCommand, NamesTheAttributesThatThereAre) {
  expect_usage_error(mesh_, {"--colour-by", "hight"}, "'hight'");
  expect_usage_error(mesh_, {"--colour-by", "hight"}, "height, x, y, z");
  expect_usage_error(cloud_, {"--colour-by", "height"}, "x, y, z");
}

TEST_F(RenderCommand, RefusesWhatMakesNoSense) {
  expect_usage_error(cloud_, {"--wireframe"}, "--wireframe");
  expect_usage_error(mesh_, {"--point-size", "5"}, "--point-size");
  expect_usage_error(mesh_, {"--range", "0,1"}, "--colour-by");
  expect_usage_error(mesh_, {"--colour-by", "height", "--range", "1,0"}, "--range");
  expect_usage_error(mesh_, {"--colour-by", "height", "--range", "1"}, "--range");
  expect_usage_error(mesh_, {"--colour-map", "rainbow"}, "rainbow");
  for (const char* up : {"w", "--z", "", "zz", "+-x"}) expect_usage_error(mesh_, {std::string("--up=") + up}, "--up");
  for (const char* zoom : {"0", "-1", "1001", "nan"}) expect_usage_error(mesh_, {"--zoom", zoom}, "--zoom");
  for (const char* fov : {"0", "180", "nan"}) expect_usage_error(mesh_, {"--fov", fov}, "--fov");
  for (const char* size : {"-1", "1e6"}) expect_usage_error(cloud_, {"--point-size", size}, "--point-size");
  expect_usage_error(mesh_, {"--fit", "cylinder"}, "cylinder");
  expect_usage_error(mesh_, {"--first", "3"}, "--first");
}

TEST_F(RenderCommand, ExplainsBackFacesAndHowToLeaveThemOut) {
  EXPECT_EQ(render_file(mesh_).err, "");
  write_mesh(folder_ / "inside_out.ply", flipped(read_mesh(mesh_)));
  const Result result = render_file(folder_ / "inside_out.ply");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.err.starts_with("pointskin: warning: 100 % of what is seen is the back")) << result.err;
  for (const char* part : {"open", "inwards", "--cull"}) EXPECT_NE(result.err.find(part), std::string::npos);
  const Result culled = render_file(folder_ / "inside_out.ply", {"--cull"});
  EXPECT_EQ(culled.err.find("--cull"), std::string::npos) << culled.err;
  write_cloud(folder_ / "turned.ply", flipped(torus_cloud(2'000, 1)));
  const Result turned = render_file(folder_ / "turned.ply");
  EXPECT_TRUE(turned.err.starts_with("pointskin: warning: ")) << turned.err;
  EXPECT_NE(turned.err.find("points turned away"), std::string::npos);
  EXPECT_EQ(render_file(cloud_).err, "");
}

TEST_F(RenderCommand, SaysWhenNothingIsInView) {
  const Result result = render_file(mesh_, {"--target", "0,0,0", "--zoom", "500"});  // through the hole
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(render_file(mesh_, {"--up", "z", "--elevation", "90", "--target", "0,0,0", "--zoom", "50"})
                .err.find("nothing is in view"),
            std::string::npos);
}

class RenderSequence : public RenderCommand {
 protected:
  /// Frames 8 to 11: a ball that stays, and one that leaves it behind.
  RenderSequence() {
    for (int frame = 8; frame <= 11; ++frame) {
      Mesh balls = icosphere_mesh(3);
      append(balls, icosphere_mesh(2, 0.3, {2.0 + (frame < 10 ? 0 : frame), 0, 0}));
      std::vector<float> times;
      for (std::size_t v = 0; v < balls.vertices.size(); ++v)
        times.push_back(static_cast<float>(frame + (v % 2 == 0 ? 0 : 1)));
      balls.attributes = {{"time", times}};
      write_mesh(frame_of(frame, ".ply"), balls);
    }
    write_file(folder_ / "frame_x.ply", "no frame");
  }

  std::string frame_of(int frame, const std::string& extension) {
    return folder_ / ("frame_" + std::to_string(frame) + extension);
  }

  Result render_all(const Args& more = {}) {
    Args args = {"render", folder_ / "frame_{}.ply", "-o", folder_ / "frame_{}.png", "--size", "160x120"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }
};

TEST_F(RenderSequence, HasOneCameraForAllFrames) {
  const Result result = render_all();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("4 frames"), std::string::npos) << result.err;
  WorldBox box = *fitted_box(read_mesh(frame_of(8, ".ply")));
  box.upper[0] = fitted_box(read_mesh(frame_of(11, ".ply")))->upper[0];
  for (int frame = 8; frame <= 11; ++frame) {
    const std::string path = folder_ / "expected.png";
    write_png(path, render(read_mesh(frame_of(frame, ".ply")), {.width = 160, .height = 120, .fit_world = box}));
    EXPECT_TRUE(read_file(frame_of(frame, ".png")) == read_file(path)) << frame;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "frame_x.png"));
}

TEST_F(RenderSequence, HasOneRangeOfColoursForAllFrames) {
  ASSERT_EQ(render_all({"--colour-by", "time", "--first", "8", "--last", "9", "-q"}).exit_code, 0);
  WorldBox box = *fitted_box(read_mesh(frame_of(8, ".ply")));
  for (const int frame : {8, 9}) {
    const std::string path = folder_ / "expected.png";
    write_png(path,
              render(read_mesh(frame_of(frame, ".ply")),
                     {.width = 160, .height = 120, .fit_world = box, .colour_by = "time", .range = ValueRange{8, 10}}));
    EXPECT_TRUE(read_file(frame_of(frame, ".png")) == read_file(path)) << frame;
  }
  EXPECT_FALSE(std::filesystem::exists(frame_of(10, ".png")));
}

TEST_F(RenderSequence, OfPointsHasOneSizeOfPoints) {
  write_cloud(folder_ / "p_1.ply", sphere_cloud(500, 1));
  write_cloud(folder_ / "p_2.ply", sphere_cloud(2'000, 1));
  Args args = {"render", folder_ / "p_{}.ply", "-o", folder_ / "p_{}.png", "--size", "160x120", "-q"};
  ASSERT_EQ(pointskin_run(args).exit_code, 0);
  RenderReport first;
  render(read_cloud(folder_ / "p_1.ply"), {.width = 160, .height = 120}, &first);
  WorldBox box = *fitted_box(read_cloud(folder_ / "p_1.ply"));
  const WorldBox other = *fitted_box(read_cloud(folder_ / "p_2.ply"));
  for (std::size_t a = 0; a < 3; ++a) {
    box.lower[a] = std::min(box.lower[a], other.lower[a]);
    box.upper[a] = std::max(box.upper[a], other.upper[a]);
  }
  write_png(picture_,
            render(read_cloud(folder_ / "p_2.ply"),
                   {.width = 160, .height = 120, .fit_world = box, .point_size_world = first.point_size_world}));
  EXPECT_TRUE(read_file(folder_ / "p_2.png") == read_file(picture_));
}

TEST_F(RenderSequence, WarnsOnceForAllFrames) {
  for (const int frame : {9, 10}) write_mesh(frame_of(frame, ".ply"), flipped(read_mesh(frame_of(frame, ".ply"))));
  const Result result = render_all({"-q"});
  EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
  EXPECT_NE(result.err.find("warning: in 2 of 4 pictures, up to 100 %"), std::string::npos) << result.err;
}

TEST_F(RenderSequence, NeedsItsNumbersInBothNames) {
  expect_error(pointskin_run({"render", folder_ / "frame_{}.ply", "-o", picture_}), 2, "{}");
  expect_error(pointskin_run({"render", mesh_, "-o", folder_ / "x_{}.png"}), 2, "{}");
  expect_error(render_all({"--first", "30"}), 3, "no such file");
}

TEST_F(RenderSequence, EndsAtABadFrameByName) {
  write_file(frame_of(10, ".ply"), "ply\nformat ascii 1.0\nelement vertex 3\n");
  expect_error(render_all(), 3, "frame_10.ply");
  EXPECT_FALSE(std::filesystem::exists(frame_of(8, ".png")));  // all are looked at before the first is drawn
}

TEST_F(RenderSequence, LeavesWholeFramesWhenItIsInterrupted) {
  for (int frame = 12; frame < 60; ++frame) std::filesystem::copy_file(frame_of(9, ".ply"), frame_of(frame, ".ply"));
  Start start;
  start.args = {"render", folder_ / "frame_{}.ply", "-o", folder_ / "frame_{}.png", "--size", "800x600", "-q"};
  start.signal = SIGINT;
  start.signal_once_written = frame_of(9, ".png");
  const Result result = run_program(start);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_NE(result.err.find("written before"), std::string::npos) << result.err;
  int frames = 0;
  for (const std::string& name : folder_.names()) {
    if (!name.ends_with(".png")) continue;
    ++frames;
    const std::string bytes = read_file(folder_ / name);
    EXPECT_EQ(bytes.substr(bytes.size() - 8, 4), "IEND") << name;
  }
  EXPECT_GE(frames, 2);
  EXPECT_LT(frames, 52);
  EXPECT_NE(result.err.find("; " + std::to_string(frames) + " frame"), std::string::npos) << result.err << frames;
}

}  // namespace
}  // namespace pointskin::test
