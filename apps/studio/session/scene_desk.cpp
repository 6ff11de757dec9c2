#include "scene_desk.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include <pointskin/camera.hpp>
#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include "ms_since.hpp"
#include "scene/options.hpp"

namespace pointskin::studio {
namespace {

/// Larger meshes are not measured: it would take longer than to make them.
constexpr std::size_t kMostMeasured = 12'000'000;

using Clock = std::chrono::steady_clock;

/// Restores what a pointer was when it is left.
class Holding {
 public:
  Holding(ProgressTeller*& place, ProgressTeller& now) : place_(place), before_(std::exchange(place, &now)) {}
  ~Holding() { place_ = before_; }
  Holding(const Holding&) = delete;
  Holding& operator=(const Holding&) = delete;

 private:
  ProgressTeller*& place_;
  ProgressTeller* before_;
};

/// What pages know a scene by.
std::string name_of(const std::filesystem::path& journal) { return journal.filename().string(); }

/// By how many depths a surface of so many triangles is too fine: every depth has a quarter of the next one's.
int levels_above(std::int64_t most, std::int64_t triangles) {
  int levels = 0;
  for (; triangles > most; triangles /= 4) ++levels;
  return levels;
}

}  // namespace

SceneDesk::Points SceneDesk::facts_of(const Cloud& cloud) {
  return {cloud.size(), bounds_of(cloud.positions), cloud.origin, cloud.has_normals()};
}

const scene::Scene& SceneDesk::present() const {
  if (scene_ == nullptr) throw Error(ErrorCode::usage, "there is no scene yet; open a cloud first");
  return *scene_;
}

SceneDesk::Opened SceneDesk::open(const scene::Document& document, const std::filesystem::path& journal) {
  Opened opened;
  scene::ReadFacts facts;
  Cloud base = load_base(document.base.clouds, {.shift = scene::shift_of(document.base.shift)},
                         scene::MissingNormals::allowed, facts);
  opened.notices = std::move(facts.notices);
  opened.points = facts_of(base);
  teller_.begin(name_of(journal));
  teller_.show_points(base, services_.most_shown);  // what was read is seen at once
  opened.dropped = facts.not_finite + facts.no_normal;
  scene::SceneOptions options;
  options.reconstruction = document.options;
  options.warm_start = document.warm_start;
  options.topology = false;  // measured here, once the page has the mesh
  options.progress = [this](const Progress& progress) { return progress_ == nullptr || (*progress_)(progress); };
  opened.scene = std::make_unique<scene::Scene>(std::move(base), options, services_.workspace);
  replay(document, *opened.scene);
  return opened;
}

/// Does what a document says, undo and redo included.
void SceneDesk::replay(const scene::Document& document, scene::Scene& scene) {
  const auto camera = [&](RenderOptions picture) {
    picture.threads = services_.device.threads;
    return camera_of(scene.mesh(), picture);
  };
  for (std::size_t i = 0; i < document.operations.size(); ++i) {
    const nlohmann::json operation = document.operations[i];
    const std::string op = operation.at("op");
    if (op == "undo")
      scene.undo();
    else if (op == "redo")
      scene.redo();
    else
      scene.apply(scene::operation_of(operation, "operations[" + std::to_string(i) + "]", {}, camera, &sources_));
  }
  const bool linear = scene.size() == document.operations.size();
  if (linear && document.done < scene.done()) scene.go_to(document.done);
}

void SceneDesk::take(Opened opened, const scene::Document& document) {
  scene_ = std::move(opened.scene);
  base_ = document.base;
  first_options_ = document.options;
  points_ = opened.points;
  base_points_ = opened.points.count;
  dropped_ = opened.dropped;
  surfaces_.clear();
  for (const std::string& notice : opened.notices)
    services_.audience.tell({{"event", "notice"}, {"level", "warning"}, {"text", notice}});
}

void SceneDesk::begin(const scene::Document& document, const std::filesystem::path& journal) {
  ProgressTeller progress(services_, "open");
  const Holding held(progress_, progress);
  const Clock::time_point start = Clock::now();
  scene::Document first = document;
  stamp_clouds(first.base);
  try {
    Opened opened = open(first, journal);
    scene::Document beginning = first;
    beginning.operations.clear();
    beginning.done = 0;
    scene::Journal begun = scene::Journal::create(journal.string(), beginning);
    for (std::size_t i = 0; i < opened.scene->size(); ++i) begun.apply(opened.scene->operation(i));
    if (opened.scene->done() < opened.scene->size()) begun.go(opened.scene->done());
    take(std::move(opened), first);
    journal_ = std::move(begun);
  } catch (...) {
    show_again();
    throw;
  }
  last_ms_ = ms_since(start);
  changed(progress.phase_ms());
  points_are_old_ = scene_->size() > 0;
}

/// The points of a scene that could not be opened make place for the scene that there is.
void SceneDesk::show_again() {
  if (scene_ == nullptr || teller_.scene() == name_of(journal_->path())) return;
  teller_.begin(name_of(journal_->path()));
  points_are_old_ = true;
  show_mesh({});
}

void SceneDesk::resume(const std::filesystem::path& journal) {
  ProgressTeller progress(services_, "resume");
  const Holding held(progress_, progress);
  const scene::Document document = scene::read_journal(journal.string());
  for (const std::string& notice : check_clouds(document.base))
    services_.audience.tell({{"event", "notice"}, {"level", "warning"}, {"text", notice}});
  Opened opened = open(document, journal);
  scene::Journal going_on = scene::Journal::open(journal.string());
  take(std::move(opened), document);
  journal_ = std::move(going_on);
  changed(progress.phase_ms());
}

scene::SceneOperation SceneDesk::operation_of(const nlohmann::json& operation) {
  const scene::Scene& scene = present();
  const auto camera = [&](RenderOptions picture) {
    picture.threads = services_.device.threads;
    return camera_of(scene.mesh(), picture);
  };
  return scene::operation_of(operation, "operation", {}, camera, &sources_);
}

Json SceneDesk::apply(const nlohmann::json& operation) {
  const scene::SceneOperation next = operation_of(operation);
  ProgressTeller progress(services_, name_of(next));
  const Holding held(progress_, progress);
  const scene::StepRecord& record = scene_->apply(next);
  const std::size_t index = scene_->done() - 1;
  try {
    journal_->apply(scene_->operation(index));
  } catch (const Error&) {
    scene_->undo();
    throw;
  }
  surfaces_.resize(index + 1);  // those of operations that were undone are forgotten
  last_ms_ = record.reconstruct_ms;
  Json ms = progress.phase_ms();
  ms["edit"] = record.edit_ms;
  changed(std::move(ms));
  return {{"record", record_json(index)}, {"index", index}, {"done", scene_->done()}};
}

Json SceneDesk::go(std::size_t done) {
  (void)present();
  ProgressTeller progress(services_, done < scene_->done() ? "undo" : "redo");
  const Holding held(progress_, progress);
  const std::size_t before = scene_->done();
  if (done != before) {
    scene_->go_to(done);
    try {
      journal_->go(done);
    } catch (const Error&) {
      scene_->go_to(before);
      throw;
    }
    changed(progress.phase_ms());
  }
  return {{"done", scene_->done()}};
}

/// What follows every change: the mesh at once, then what was measured of it.
void SceneDesk::changed(Json ms) {
  ++state_number_;
  points_are_old_ = true;
  points_.count = scene_->done() == 0 ? base_points_ : scene_->record(scene_->done() - 1).points;
  points_.has_normals = !scene_->mesh().triangles.empty();
  show_mesh(std::move(ms));
  measure_surface();
  tell_state();
}

void SceneDesk::show_mesh(Json ms) {
  MeshFacts facts;
  facts.full_triangles = static_cast<std::int64_t>(present().mesh().triangles.size());
  facts.ms = std::move(ms);
  coarse_.reset();
  if (facts.full_triangles > services_.most_shown) make_coarse();
  facts.depth = shown_depth();
  teller_.show(shown(), facts);
}

void SceneDesk::make_coarse() {
  const Cloud cloud = scene_->cloud();
  Options options = scene_->options();
  options.point_normals = PointNormals::given;
  options.keep_strays = true;
  Reconstructor reconstructor(services_.workspace);
  Mesh coarse;
  auto triangles = static_cast<std::int64_t>(scene_->mesh().triangles.size());
  do {
    options.depth = std::max(1, options.depth - levels_above(services_.most_shown, triangles));
    reconstructor.reconstruct(cloud, options, coarse);
    triangles = static_cast<std::int64_t>(coarse.triangles.size());
  } while (triangles > services_.most_shown && options.depth > 1);
  coarse_ = std::move(coarse);
  coarse_depth_ = options.depth;
}

void SceneDesk::measure_surface() {
  const std::size_t done = scene_->done();
  if (surfaces_.size() <= done) surfaces_.resize(done + 1);
  const Mesh& mesh = scene_->mesh();
  if (surfaces_[done] || mesh.triangles.empty() || mesh.triangles.size() > kMostMeasured) return;
  surfaces_[done] = measure(mesh, services_.device.threads);
}

bool SceneDesk::work_ahead() {
  if (!points_are_old_ || scene_ == nullptr) return false;
  points_are_old_ = false;
  const Cloud cloud = scene_->cloud();
  points_ = facts_of(cloud);
  teller_.show_points(cloud, services_.most_shown);
  tell_state();
  return true;
}

scene::Document SceneDesk::document() const {
  const scene::Scene& scene = present();
  scene::Document document;
  document.base = base_;
  document.options = first_options_;
  document.options_given = scene::option_keys();
  document.done = scene.done();
  for (std::size_t i = 0; i < scene.size(); ++i) document.operations.push_back(scene::to_json(scene.operation(i), {}));
  return document;
}

}  // namespace pointskin::studio
