// The states of an editing session in a space: each is a cloud with its field and its surface.
#pragma once

#include <pointskin/edit.hpp>

#include <cstdint>
#include <memory>

#include "envelope/envelope.hpp"
#include "exec/space.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/points.hpp"
#include "surface/extract.hpp"

namespace pointskin::edit {

/// Never changed once it is made, but for what can be made again. Steps that change nothing share it.
struct State {
  detail::PointBuffers points;
  detail::FieldData field;  ///< without samples while it is slim
  surface::Surface surface;
  std::int64_t bytes = 0;  ///< of memory, when it is not slim

  [[nodiscard]] bool is_slim() const { return field.samples.positions.empty(); }
  /// Frees what follows from the points.
  void slim() { field.samples = {}; }
};
using SharedState = std::shared_ptr<State>;

/// Gives a state all that make_next() and preview() need. O(points) if it is slim.
template <exec::Space Exec>
void make_whole(Exec& ex, State& state);

/// What all states of a session have in common.
struct Settings {
  EditOptions options;
  Vec3d origin{};                                      ///< of the base cloud: what places are relative to
  std::shared_ptr<const envelope::Envelope> envelope;  ///< or null
  Bounds base_box;                                     ///< of the original points
  double normal_length = 1;                            ///< of normals that are made
};

/// The state of a session whose operations are none.
struct Beginning {
  Settings settings;
  SharedState state;
};

/// @param options  valid
/// @throws Error as Reconstructor::solve
template <exec::Space Exec>
Beginning begin_session(Exec& ex, const Cloud& base, const EditOptions& options);

/// The state after an operation: that before, if it changes nothing.
/// @param before     whole
/// @param operation  valid
/// @param report     receives all but triangles, topology and total_ms
/// @throws Error as find_change and changed_points; as Reconstructor::solve
template <exec::Space Exec>
SharedState make_next(Exec& ex, const Settings& settings, const SharedState& before, const Operation& operation,
                      StepReport& report);

/// What an operation would do to the points of a state, which is whole, as EditSession::preview. Waits.
/// @param operation  valid
template <exec::Space Exec>
EditPreview preview(Exec& ex, const Settings& settings, const State& state, const Operation& operation);

/// Copies the surface of a state to the host. Waits.
template <exec::Space Exec>
void show(Exec& ex, const Settings& settings, const State& state, Mesh& mesh);

/// The points of a state, as EditSession::cloud.
template <exec::Space Exec>
Cloud copy_cloud(Exec& ex, const Settings& settings, const State& state);

}  // namespace pointskin::edit
