#include "scene/scene.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "scene/combine.hpp"
#include "scene/history.hpp"
#include "scene/segment.hpp"
#include "scene/sources.hpp"
#include "scene/stage.hpp"

namespace pointskin::scene {
namespace {

std::shared_ptr<const Stage> base_stage(Cloud base, const Options& options) {
  if (options.offset != 0) throw Error(ErrorCode::usage, "option offset must be 0 in a scene");
  auto stage = std::make_shared<Stage>();
  if (!base.has_normals()) {
    auto none = std::make_shared<Mesh>();
    none->origin = base.origin;
    stage->mesh = std::move(none);
  }
  stage->cloud = std::make_shared<const Cloud>(std::move(base));
  stage->options = options;
  stage->options.progress = nullptr;
  return stage;
}

/// The operation as the history keeps it: what is read from files is there to stay.
SceneOperation with_solid(SceneOperation operation, int threads) {
  if (auto* combine = std::get_if<Combine>(&operation); combine != nullptr && combine->solid == nullptr)
    combine->solid = Sources(threads).solid(combine->with);
  return operation;
}

}  // namespace

class Scene::Impl {
 public:
  Impl(Cloud base, SceneOptions options, Workspace workspace)
      : options_(with_cancelling(std::move(options))),
        workspace_(std::move(workspace)),
        history_(base_stage(std::move(base), options_.reconstruction)),
        present_(history_.stage(0), 0) {
    present_.settle(options_, workspace_);
    base_topology_ = measured();
  }

  const StepRecord& apply(const SceneOperation& operation) {
    if (is_edit(operation))
      edit(operation);
    else
      make_stage(with_solid(operation, workspace_.device().threads));
    history_.fit(done(), options_.checkpoint_bytes);
    return history_.step(done() - 1).record;
  }

  void go_to(std::size_t target) {
    if (target > history_.size())
      throw Error(ErrorCode::usage, fmt::format("there are {} operations, not {}", history_.size(), target));
    const std::size_t begin = history_.stage_begin(target);
    if (begin == present_.begin()) return walk_or_return(target);
    Segment other = segment_at(begin);
    walk(other, target);
    present_ = std::move(other);
    history_.fit(done(), options_.checkpoint_bytes);
  }

  [[nodiscard]] EditPreview preview(const SceneOperation& operation) {
    if (!is_edit(operation))
      throw Error(ErrorCode::usage, fmt::format("a preview of points is not for {}", name_of(operation)));
    present_.settle(options_, workspace_);
    return present_.preview(edit_of(operation));
  }

  [[nodiscard]] Cloud cloud() {
    if (!present_.stage()->continued) present_.settle(options_, workspace_);
    return present_.cloud();
  }

  [[nodiscard]] Topology topology() const {
    return done() == 0 ? base_topology_ : history_.step(done() - 1).record.after;
  }
  [[nodiscard]] std::size_t done() const { return present_.done(); }
  [[nodiscard]] const History& history() const { return history_; }
  [[nodiscard]] const Segment& present() const { return present_; }
  [[nodiscard]] const Workspace& workspace() const { return workspace_; }

 private:
  /// Progress that cannot cancel while the scene goes back to where it was.
  SceneOptions with_cancelling(SceneOptions options) {
    if (options.progress)
      options.progress = [asked = options.progress, returning = returning_](const Progress& progress) {
        return asked(progress) || *returning;
      };
    return options;
  }

  [[nodiscard]] Topology measured() const {
    const Mesh& mesh = present_.mesh();
    return options_.topology && !mesh.triangles.empty() ? topology_of(mesh) : Topology();
  }
  [[nodiscard]] Topology topology_of(const Mesh& mesh) const {
    const MeshReport report = measure(mesh, workspace_.device().threads);
    return {report.components,
            report.components - static_cast<std::int64_t>(std::floor(static_cast<double>(report.euler) / 2)),
            report.euler};
  }

  void edit(const SceneOperation& operation) {
    const Topology before = topology();
    const std::size_t done_before = done();
    present_.settle(options_, workspace_);
    const StepReport& report = present_.apply(edit_of(operation));
    StepRecord record;
    record.operation = report.operation;
    record.added = report.added;
    record.removed = report.removed;
    record.flipped = report.flipped;
    record.points = report.points;
    record.triangles = report.triangles;
    record.warm = report.warm;
    record.snapped = report.snapped;
    record.edit_ms = report.edit_ms;
    record.reconstruct_ms = report.reconstruct_ms;
    record.total_ms = report.total_ms;
    record.before = before;
    record.after = measured();
    history_.append(done_before, {settled(operation), std::move(record), nullptr});
  }

  /// With the number that the session used where the operation has none.
  [[nodiscard]] SceneOperation settled(const SceneOperation& operation) const {
    const auto* const guide = std::get_if<Guide>(&operation);
    if (guide == nullptr || guide->interval > 0) return operation;
    return std::get<Guide>(present_.last());
  }

  void make_stage(const SceneOperation& operation) {
    StepRecord record;
    record.before = topology();
    auto stage = std::make_shared<const Stage>(next_stage(present_, operation, record));
    if (options_.topology && !stage->mesh->triangles.empty()) record.after = topology_of(*stage->mesh);
    const std::size_t done_before = done();
    history_.append(done_before, {operation, std::move(record), stage});
    present_ = Segment(std::move(stage), done_before + 1);
  }

  /// What `operation` makes of where `segment` is.
  Stage next_stage(Segment& segment, const SceneOperation& operation, StepRecord& record) {
    const Stage& from = *segment.stage();
    const bool at_begin = segment.done() == segment.begin();
    Stage before{from.cloud, nullptr, from.options, from.continued};
    if (!(at_begin && from.continued)) {
      segment.settle(options_, workspace_);
      before.continued = segment.has_session();
      if (segment.has_session()) before.cloud = std::make_shared<const Cloud>(segment.cloud());
    }
    return StageMaker{workspace_, options_.progress}.make(before, operation, record);
  }

  /// Does operations, or undoes them, until `target` of the scene are done.
  void walk(Segment& segment, std::size_t target) {
    if (target > segment.done() || segment.stage()->mesh == nullptr) segment.settle(options_, workspace_);
    while (segment.done() > target) segment.undo();
    while (segment.done() < target)
      if (!segment.redo()) segment.apply(edit_of(history_.step(segment.done()).operation));
  }

  /// The same in the present segment; on an error it is where it was.
  void walk_or_return(std::size_t target) {
    const std::size_t before = done();
    try {
      walk(present_, target);
    } catch (...) {
      *returning_ = true;
      walk(present_, before);
      *returning_ = false;
      throw;
    }
  }

  /// The segment that begins at `begin`: from its stage, or made again from the nearest one before that is kept.
  Segment segment_at(std::size_t begin) {
    std::size_t at = history_.kept_begin(begin);
    const bool nearer = present_.begin() > at && present_.begin() < begin;
    if (nearer) at = present_.begin();
    Segment segment(nearer ? present_.stage() : history_.stage(at), at);
    while (at < begin) {
      std::size_t next = at + 1;
      while (history_.stage_begin(next) != next) ++next;
      walk(segment, next - 1);
      StepRecord unused;
      auto stage = std::make_shared<const Stage>(next_stage(segment, history_.step(next - 1).operation, unused));
      history_.keep(next, stage);
      history_.fit(begin, options_.checkpoint_bytes);
      segment = Segment(std::move(stage), next);
      at = next;
    }
    return segment;
  }

  std::shared_ptr<bool> returning_ = std::make_shared<bool>(false);
  SceneOptions options_;
  Workspace workspace_;
  History history_;
  Segment present_;
  Topology base_topology_;
};

Scene::Scene(Cloud base, SceneOptions options, Workspace workspace)
    : impl_(std::make_unique<Impl>(std::move(base), std::move(options), std::move(workspace))) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

const StepRecord& Scene::apply(const SceneOperation& operation) { return impl_->apply(operation); }

bool Scene::undo() {
  if (done() == 0) return false;
  go_to(done() - 1);
  return true;
}

bool Scene::redo() {
  if (done() == size()) return false;
  go_to(done() + 1);
  return true;
}

void Scene::go_to(std::size_t done) { impl_->go_to(done); }
std::size_t Scene::done() const { return impl_->done(); }
std::size_t Scene::size() const { return impl_->history().size(); }
const StepRecord& Scene::record(std::size_t i) const { return impl_->history().step(i).record; }
const SceneOperation& Scene::operation(std::size_t i) const { return impl_->history().step(i).operation; }
const Mesh& Scene::mesh() const { return impl_->present().mesh(); }
Cloud Scene::cloud() const { return impl_->cloud(); }
const Options& Scene::options() const { return impl_->present().stage()->options; }
Topology Scene::topology() const { return impl_->topology(); }
EditPreview Scene::preview(const SceneOperation& operation) const { return impl_->preview(operation); }
Workspace Scene::workspace() const { return impl_->workspace(); }

}  // namespace pointskin::scene
