#pragma once

#include <chrono>
#include <cstddef>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "edit/point_kind.hpp"
#include "edit/points.hpp"
#include "edit/session.hpp"
#include "exec/algorithms.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/points.hpp"
#include "reconstruct/within_envelope.hpp"

namespace pointskin::detail {

template <exec::Space Exec>
class SessionOn final : public EditSession::Impl {
 public:
  SessionOn(std::shared_ptr<Exec> ex, const Cloud& base, const EditOptions& options)
      : ex_(std::move(ex)), options_(options), origin_(base.origin) {
    if constexpr (std::is_same_v<Exec, exec::Cpu>) threads_ = ex_->threads();
    options_.reconstruction.residuals = false;  // nobody sees them, and they cost more than the solve
    envelope_ = make_envelope(*ex_, options_.reconstruction, origin_);
    states_.push_back(make_base(base));
    show(*states_.front());
    if (options_.topology) base_topology_ = topology_of(mesh_, threads_);
  }

  const StepReport& apply(const Operation& operation) override {
    ex_->activate();
    StepReport report;
    std::shared_ptr<const State> next = make_next(states_[done_], operation, report);  // may throw: nothing has changed
    Watch watch(*ex_);
    if (next != states_[done_]) show(*next);
    report.reconstruct_ms += watch.lap();
    report.total_ms = report.edit_ms + report.reconstruct_ms;
    report.triangles = static_cast<std::int64_t>(mesh_.triangles.size());
    report.before = done_ == 0 ? base_topology_ : steps_[done_ - 1].report.after;
    report.after = next == states_[done_] || !options_.topology ? report.before : topology_of(mesh_, threads_);
    steps_.resize(done_);
    states_.resize(done_ + 1);
    steps_.push_back({operation, std::move(report)});
    states_.push_back(std::move(next));
    go_to(done_ + 1);
    return steps_.back().report;
  }

  bool undo() override {
    if (done_ == 0) return false;
    go_to(done_ - 1);
    show(*states_[done_]);
    return true;
  }

  bool redo() override {
    if (done_ == steps_.size()) return false;
    go_to(done_ + 1);
    show(*states_[done_]);
    return true;
  }

  [[nodiscard]] std::vector<Operation> operations() const override {
    std::vector<Operation> operations;
    for (std::size_t i = 0; i < done_; ++i) operations.push_back(steps_[i].operation);
    return operations;
  }

  [[nodiscard]] std::vector<StepReport> steps() const override {
    std::vector<StepReport> reports;
    for (std::size_t i = 0; i < done_; ++i) reports.push_back(steps_[i].report);
    return reports;
  }

  [[nodiscard]] const Mesh& mesh() const override { return mesh_; }

  [[nodiscard]] Cloud cloud() const override {
    ex_->activate();
    const PointBuffers& points = states_[done_]->points;
    Cloud cloud;
    cloud.origin = origin_;
    copy_out(points.positions, cloud.positions);
    copy_out(points.normals, cloud.normals);
    for (const AttributeBuffer& attribute : points.attributes)
      cloud.attributes.push_back(
          {attribute.name, exec::download_typed(*ex_, exec::copy_typed(*ex_, attribute.values))});
    std::vector<std::uint8_t> kinds;
    copy_out(points.added, kinds);
    cloud.attributes.push_back({"added", std::move(kinds)});
    return cloud;
  }

 private:
  /// A cloud with its field and its surface, all on the device. Steps that change nothing share it.
  struct State {
    PointBuffers points;
    FieldData field;
    surface::Surface surface;
  };
  struct Step {
    Operation operation;
    StepReport report;
  };

  /// Milliseconds of the host, the device's work being done.
  class Watch {
   public:
    explicit Watch(Exec& ex) : ex_(ex), start_(Clock::now()) {}
    double lap() {
      ex_.synchronize();
      const auto now = Clock::now();
      return std::chrono::duration<double, std::milli>(now - std::exchange(start_, now)).count();
    }

   private:
    using Clock = std::chrono::steady_clock;
    Exec& ex_;
    Clock::time_point start_;
  };

  template <class T>
  void copy_out(const exec::Buffer<T>& from, std::vector<T>& to) const {
    to.resize(static_cast<std::size_t>(from.size()));
    copy_to_host(*ex_, from.cview(), to.data());
  }

  std::shared_ptr<const State> make_base(const Cloud& base) {
    ex_->activate();
    auto state = std::make_shared<State>();
    PointBuffers points = upload(*ex_, base);
    points.attributes = upload_attributes(*ex_, base, options_.reconstruction);
    RunReport unused;
    state->field = fit_field(*ex_, points, {.keep_points = true, .envelope = envelope_, .keep_samples = true},
                             options_.reconstruction, unused);
    state->points = copy_used(*ex_, points);  // strays are gone for good
    state->points.added = zeros(state->points.positions.size());
    state->field.samples.added = zeros(state->field.samples.positions.size());
    base_box_ = octree::box_around(*ex_, state->points.positions.cview());
    if (options_.reconstruction.confidence) normal_length_ = mean_length(*ex_, state->points.normals.cview());
    extract(*state);
    return state;
  }

  exec::Buffer<std::uint8_t> zeros(std::int64_t size) const {
    auto buffer = exec::make_buffer<std::uint8_t>(*ex_, size);
    exec::fill(*ex_, buffer.view(), edit::kOriginal);
    return buffer;
  }

  void extract(State& state) const {
    RunReport unused;
    state.surface = extract_some(*ex_, state.field, options_.reconstruction, unused);
  }

  /// Copies the surface of a state to the host.
  void show(const State& state) {
    const surface::Surface& from = state.surface;
    surface::Surface copy{copy_of(from.positions), copy_of(from.normals), copy_of(from.triangles)};
    download_mesh(*ex_, state.field, std::move(copy), options_.reconstruction, origin_, mesh_);
  }
  template <class T>
  exec::Buffer<T> copy_of(const exec::Buffer<T>& from) const {
    auto to = exec::make_buffer<T>(*ex_, from.size());
    exec::copy(*ex_, from.cview(), to.view());
    return to;
  }

  /// The state after an operation: that before, if it changes nothing.
  std::shared_ptr<const State> make_next(const std::shared_ptr<const State>& before, const Operation& operation,
                                         StepReport& report) const {
    validate(operation);
    Watch watch(*ex_);
    EditedPoints edited = edit_points(
        *ex_, {before->points, before->field, origin_, base_box_, normal_length_, options_.reconstruction}, operation);
    report.edit_ms = watch.lap();
    std::shared_ptr<const State> next = before;
    if (edited.changed()) {
      auto state = std::make_shared<State>();
      state->points = std::move(edited.points);
      report.warm = fit(*before, std::holds_alternative<Insert>(operation), *state);
      extract(*state);
      next = std::move(state);
    }
    report.reconstruct_ms = watch.lap();
    report.operation = name_of(operation);
    report.added = edited.added;
    report.removed = edited.removed;
    report.snapped = edited.snapped;
    report.points = next->points.positions.size();
    return next;
  }

  static const char* name_of(const Operation& operation) {
    constexpr const char* kNames[] = {"guide", "remove", "insert"};
    static_assert(std::size(kNames) == std::variant_size_v<Operation>);
    return kNames[operation.index()];
  }

  /// Fits the field of a state whose points are there. @returns whether it started from the field before
  bool fit(const State& before, bool may_leave_cube, State& state) const {
    FitSetup setup{.keep_points = true, .cube = before.field.frame, .envelope = envelope_, .keep_samples = true};
    if (may_leave_cube) setup.cube = cube_for(before.field.frame, state.points);
    const bool solves = options_.reconstruction.field == FieldKind::poisson;
    const bool warm = solves && options_.warm_start && *setup.cube == before.field.frame;
    if (warm) setup.before = &before.field;
    RunReport unused;
    state.field = fit_field(*ex_, state.points, setup, options_.reconstruction, unused);
    return warm;
  }

  /// The cube before if all points are well inside of it, else one around them.
  octree::Frame cube_for(const octree::Frame& before, const PointBuffers& points) const {
    const Bounds box = octree::box_around(*ex_, points.positions.cview());
    const double scale = options_.reconstruction.scale;
    const auto margin = static_cast<float>((1 - 1 / scale) / 4);  // half of what is left around a cube of its own
    const Vec3f lower = before.to_unit(box.lower);
    const Vec3f upper = before.to_unit(box.upper);
    const bool inside = lower.x >= margin && lower.y >= margin && lower.z >= margin && upper.x <= 1 - margin &&
                        upper.y <= 1 - margin && upper.z <= 1 - margin;
    return inside ? before : octree::frame_around(box, scale);
  }

  /// Makes this state the present one; makes it again if it has been forgotten.
  void go_to(std::size_t done) {
    ex_->activate();
    std::size_t from = done;
    while (states_[from] == nullptr) --from;  // the base is never forgotten
    for (StepReport unused; from < done; ++from)
      states_[from + 1] = make_next(states_[from], steps_[from].operation, unused);
    done_ = done;
    const auto kept = static_cast<std::size_t>(options_.states_kept);
    for (std::size_t i = 1; i < states_.size(); ++i)
      if (i + kept <= done_ || i >= done_ + kept) states_[i] = nullptr;
  }

  std::shared_ptr<Exec> ex_;
  EditOptions options_;
  Vec3d origin_;
  int threads_ = 0;
  std::shared_ptr<const envelope::Envelope> envelope_;
  Bounds base_box_;
  double normal_length_ = 1;
  Topology base_topology_;
  std::vector<Step> steps_;                           ///< done and undone
  std::vector<std::shared_ptr<const State>> states_;  ///< steps_ + 1; null: to be made again
  std::size_t done_ = 0;
  Mesh mesh_;  ///< of the present state
};

}  // namespace pointskin::detail
