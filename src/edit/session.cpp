#include <pointskin/edit.hpp>
#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "core/stopwatch.hpp"
#include "edit/change.hpp"
#include "edit/require.hpp"
#include "edit/states.hpp"
#include "exec/any_space.hpp"
#include "reconstruct/engine.hpp"

namespace pointskin {
namespace {

const EditOptions& checked(const EditOptions& options) {
  detail::validate_settled(options.reconstruction);
  edit::require(options.reconstruction.offset == 0, "option offset must be 0 in an editing session");
  edit::require(options.states_kept >= 1, "option states_kept must be at least 1");
  edit::require(options.undo_bytes >= 0, "option undo_bytes must not be negative");
  return options;
}

/// Where memory is limited, states for undo take no more than a quarter of it.
EditOptions leave_room(EditOptions options, std::int64_t limit) {
  if (limit > 0) options.undo_bytes = std::min(options.undo_bytes, limit / 4);
  return options;
}

/// Components, genus and Euler number. O(t log t), on the host.
Topology topology_of(const Mesh& mesh, int threads) {
  const MeshReport report = measure(mesh, threads);
  return {report.components,
          report.components - static_cast<std::int64_t>(std::floor(static_cast<double>(report.euler) / 2)),
          report.euler};
}

}  // namespace

/// With numbers where the operation leaves them to the surface before it.
Operation settled(Operation operation, const edit::State& before) {
  if (auto* guide = std::get_if<Guide>(&operation)) guide->interval = edit::interval_of(*guide, before.field);
  return operation;
}

/// The history of a session.
class PSK_HIDDEN EditSession::Impl {
 public:
  Impl(const Cloud& base, const EditOptions& options, Workspace workspace) : workspace_(std::move(workspace)) {
    const EditOptions with_room = leave_room(checked(options), space().pool()->limit());
    edit::Beginning beginning =
        exec::visit(space(), [&](auto& ex) { return edit::begin_session(ex, base, with_room); });
    settings_ = std::move(beginning.settings);
    states_.push_back(std::move(beginning.state));
    show(*states_.front());
    base_topology_ = topology({});
  }

  [[nodiscard]] const Device& device() const { return workspace_.device(); }

  const StepReport& apply(const Operation& operation) {
    StepReport report;
    if (is_over_budget()) keep_only_base();
    edit::SharedState next = make_next(states_[done_], operation, report);  // may throw: nothing has changed
    const bool changed = next != states_[done_];
    const Stopwatch watch;
    if (changed) show(*next);
    report.reconstruct_ms += watch.milliseconds();
    report.total_ms = report.edit_ms + report.reconstruct_ms;
    report.triangles = static_cast<std::int64_t>(mesh_.triangles.size());
    report.before = done_ == 0 ? base_topology_ : steps_[done_ - 1].report.after;
    report.after = changed ? topology(report.before) : report.before;
    steps_.resize(done_);
    states_.resize(done_ + 1);
    steps_.push_back({settled(operation, *states_[done_]), std::move(report)});
    states_.push_back(std::move(next));
    go_to(done_ + 1);
    return steps_.back().report;
  }

  [[nodiscard]] EditPreview preview(const Operation& operation) const {
    edit::validate(operation);
    return exec::visit(space(), [&](auto& ex) {
      edit::make_whole(ex, *states_[done_]);
      return edit::preview(ex, settings_, *states_[done_], operation);
    });
  }

  bool undo() {
    if (done_ == 0) return false;
    go_to(done_ - 1);
    show(*states_[done_]);
    return true;
  }

  bool redo() {
    if (done_ == steps_.size()) return false;
    go_to(done_ + 1);
    show(*states_[done_]);
    return true;
  }

  [[nodiscard]] std::vector<Operation> operations() const {
    std::vector<Operation> operations;
    for (std::size_t i = 0; i < done_; ++i) operations.push_back(steps_[i].operation);
    return operations;
  }

  [[nodiscard]] std::vector<StepReport> steps() const {
    std::vector<StepReport> reports;
    for (std::size_t i = 0; i < done_; ++i) reports.push_back(steps_[i].report);
    return reports;
  }

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }

  [[nodiscard]] Cloud cloud() const {
    return exec::visit(space(), [&](auto& ex) { return edit::copy_cloud(ex, settings_, *states_[done_]); });
  }

 private:
  struct Step {
    Operation operation;
    StepReport report;
  };

  void show(const edit::State& state) {
    exec::visit(space(), [&](auto& ex) { edit::show(ex, settings_, state, mesh_); });
  }

  edit::SharedState make_next(const edit::SharedState& before, const Operation& operation, StepReport& report) const {
    edit::validate(operation);
    return exec::visit(space(), [&](auto& ex) {
      edit::make_whole(ex, *before);
      return edit::make_next(ex, settings_, before, operation, report);
    });
  }

  /// Of the mesh, or what is known where the options want none.
  [[nodiscard]] Topology topology(const Topology& known) const {
    if (!settings_.options.topology) return known;
    return topology_of(mesh_, exec::visit(space(), [](auto& ex) { return ex.host_threads(); }));
  }

  /// Makes this state the present one; makes it again if it has been forgotten.
  void go_to(std::size_t done) {
    std::size_t from = done;
    while (states_[from] == nullptr) --from;  // the base is never forgotten
    for (StepReport unused; from < done; ++from) {
      states_[from + 1] = make_next(states_[from], steps_[from].operation, unused);
      done_ = from + 1;
      forget_some();
    }
    done_ = done;
    forget_some();
  }

  /// What the present state leaves of the others.
  void forget_some() {
    const auto kept = static_cast<std::size_t>(settings_.options.states_kept);
    for (std::size_t i = 1; i < states_.size(); ++i)
      if (i + kept <= done_ || i >= done_ + kept) states_[i] = nullptr;
    if (!is_over_budget()) return;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i] == nullptr || states_[i] == states_[done_]) continue;
      if (i == 0 || i + 1 == done_)
        states_[i]->slim();
      else
        states_[i] = nullptr;
    }
  }

  /// Before the next state is made.
  void keep_only_base() {
    for (std::size_t i = 1; i < states_.size(); ++i)
      if (i != done_) states_[i] = nullptr;
  }

  /// Whether the states besides the present one would take more than they may, if they were whole.
  [[nodiscard]] bool is_over_budget() const {
    std::int64_t bytes = 0;
    const edit::State* last = states_[done_].get();
    for (const edit::SharedState& state : states_) {  // equal ones stand side by side
      if (state == nullptr || state == states_[done_] || state.get() == last) continue;
      last = state.get();
      bytes += last->bytes;
    }
    return bytes > settings_.options.undo_bytes;
  }

  [[nodiscard]] const exec::AnySpace& space() const { return workspace_.data().space; }

  Workspace workspace_;
  edit::Settings settings_;
  Topology base_topology_;
  std::vector<Step> steps_;                ///< done and undone
  std::vector<edit::SharedState> states_;  ///< steps_ + 1; null: to be made again
  std::size_t done_ = 0;
  Mesh mesh_;  ///< of the present state
};

EditSession::EditSession(const Cloud& base, const EditOptions& options, Workspace workspace)
    : impl_(std::make_unique<Impl>(base, options, std::move(workspace))) {}
EditSession::~EditSession() = default;
EditSession::EditSession(EditSession&&) noexcept = default;
EditSession& EditSession::operator=(EditSession&&) noexcept = default;

const StepReport& EditSession::apply(const Operation& operation) { return impl_->apply(operation); }
EditPreview EditSession::preview(const Operation& operation) const { return impl_->preview(operation); }
bool EditSession::undo() { return impl_->undo(); }
bool EditSession::redo() { return impl_->redo(); }
std::vector<Operation> EditSession::operations() const { return impl_->operations(); }
std::vector<StepReport> EditSession::steps() const { return impl_->steps(); }
const Mesh& EditSession::mesh() const { return impl_->mesh(); }
Cloud EditSession::cloud() const { return impl_->cloud(); }
const Device& EditSession::device() const { return impl_->device(); }

}  // namespace pointskin
