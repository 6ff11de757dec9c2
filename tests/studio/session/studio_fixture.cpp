#include "studio/session/studio_fixture.hpp"

#include <cstdlib>
#include <utility>

#include <pointskin/io.hpp>

#include "scene/document.hpp"
#include "scene/scene.hpp"
#include "scene/sha256.hpp"

namespace pointskin::test {

namespace fs = std::filesystem;

StudioTest::StudioTest() {
  std::string pattern = (fs::temp_directory_path() / "pointskin_studio_XXXXXX").string();
  base_ = mkdtemp(pattern.data());
  root_ = base_ / "root";
  folder_ = base_ / "state";
  fs::create_directories(root_);
}

StudioTest::~StudioTest() {
  stop();
  fs::remove_all(base_);
}

void StudioTest::start(studio::StudioOptions options) {
  stop();
  options.device = Device::cpu(2);
  options.roots = {root_};
  options.folder = folder_;
  studio_ = std::make_unique<studio::Studio>(std::move(options));
  page_ = std::make_unique<Page>(*studio_);
}

void StudioTest::stop() {
  page_.reset();
  studio_.reset();
}

void StudioTest::open_shape(const std::string& name, int points, int depth) {
  if (studio_ == nullptr) start();
  const Json shape = {{"shape", name}, {"points", points}};
  (void)page().ask("open", {{"files", {shape}}, {"options", {{"depth", depth}}}});
}

Json StudioTest::scene() { return page().last("state").at("scene"); }

BlobReader StudioTest::blob(const Json& id, bool compressed) {
  const auto bytes = studio_->blob(id.get<std::uint64_t>(), compressed);
  if (bytes == nullptr) throw std::runtime_error("there is no blob " + id.dump());
  return BlobReader(bytes->data);
}

Json front_camera() {
  constexpr double kScale = 1 / 1.1;
  return {{"view", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -3, 0, 0, 0, 1}},
          {"projection", {kScale, 0, 0, 0, 0, kScale, 0, 0, 0, 0, -0.1, 0, 0, 0, 0, 1}},
          {"width", 200},
          {"height", 200}};
}

Json pixel(double x, double y) { return {100 + 100 * x / 1.1, 100 - 100 * y / 1.1}; }

Json guide(const std::vector<Json>& stroke, double interval) {
  return {{"op", "guide"}, {"camera", front_camera()}, {"stroke", stroke}, {"interval", interval}};
}

Json in_rectangle(const std::string& what, const Json& corner, const Json& opposite) {
  Json operation = {
      {"op", what}, {"camera", front_camera()}, {"rectangle", {corner[0], corner[1], opposite[0], opposite[1]}}};
  if (what == "remove") operation["originals"] = true;
  return operation;
}

Json lift(double height) {
  const Json held = {{"region", {{"half_space", {{"point", {-0.5, 0, 0}}, {"normal", {-1, 0, 0}}}}}}};
  const Json moved = {{"region", {{"ball", {{"centre", {0.9, 0, 0}}, {"radius", 0.2}}}}},
                      {"rigid", {{"translation", {0, 0, height}}}}};
  return {{"op", "deform"}, {"handles", {held, moved}}};
}

Json combine(const std::string& operation, const Json& with, double x) {
  return {{"op", "boolean"}, {"operation", operation}, {"with", with}, {"translation", {x, 0, 0}}};
}

std::string digest_of(const Mesh& mesh, const fs::path& folder) {
  const fs::path file = folder / "digest.ply";
  write_mesh(file.string(), mesh);
  std::string digest = scene::sha256_of_file(file.string());
  fs::remove(file);
  return digest;
}

std::string replayed(const std::string& shape, int points, int depth, const std::vector<Json>& operations) {
  scene::SceneOptions options;
  options.reconstruction.depth = depth;
  scene::Scene scene(scene::shape_cloud(shape, points), options, Workspace(Device::cpu(1)));
  const auto camera = [&scene](const RenderOptions& picture) { return camera_of(scene.mesh(), picture); };
  for (const Json& operation : operations) scene.apply(scene::operation_of(operation, "operation", {}, camera));
  std::string pattern = (fs::temp_directory_path() / "pointskin_replay_XXXXXX").string();
  const fs::path folder = mkdtemp(pattern.data());
  std::string digest = digest_of(scene.mesh(), folder);
  fs::remove_all(folder);
  return digest;
}

}  // namespace pointskin::test
