// A scene that is worked on: a base cloud, a list of operations on it, and the points and the surface after those that
// are done.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/edit.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/progress.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

#include "scene/operations.hpp"

namespace pointskin::scene {

/// What an operation did and what it cost.
struct StepRecord {
  std::string operation;                                 ///< name_of()
  std::int64_t added = 0, removed = 0, flipped = 0;      ///< points; flipped: those whose normals were turned round
  std::int64_t points = 0, triangles = 0;                ///< after it
  Topology before, after;                                ///< zero without SceneOptions::topology
  bool warm = false, snapped = false;                    ///< StepReport
  double edit_ms = 0, reconstruct_ms = 0, total_ms = 0;  ///< without measuring the topology
  std::vector<std::string> notes;  ///< what people should know: assumptions, warnings; a line each
};

struct SceneOptions {
  Options reconstruction;  ///< of the first state; `offset` must be 0, `progress` does not count
  bool warm_start = true;  ///< EditOptions::warm_start
  bool topology = true;    ///< measure components and genus of every surface
  /// Host memory for what undo needs across deform, boolean, orient and options: the cloud and the mesh that each of
  /// them made. Those that do not fit are made again from the one before. 0: none is kept.
  std::int64_t checkpoint_bytes = std::int64_t{1} << 30;
  /// Called from the thread that works, for every reconstruction and estimation of an operation from the beginning;
  /// false cancels (Error interrupted), and the scene stays as it was.
  std::function<bool(const Progress&)> progress;
};

/// A chain of states, each with points and a surface. Guide, remove, flip and insert are those of an EditSession, which
/// goes on until a deform, boolean, orient or options: these make the surface themselves (Deformer, Booleans,
/// Reconstructor), and their points are the base of the next session, where originals and added points stay what they
/// were, no stray is left out any more, and normals are taken as given.
///
/// Every state follows from the base cloud, the options and the operations up to it: undo, redo and a replay give the
/// same bytes, on any device and with any number of threads.
///
/// Memory on the host, beyond what the engine holds: the base cloud; cloud and mesh that the last deform, boolean,
/// orient or options made; clouds, meshes and solids that operations bring in; and checkpoint_bytes. With 20 million
/// points, 40 million triangles and no part this is 0.5 + 0.5 + 1 + 1 GB. While such an operation or an undo across one
/// runs, the state before it is held, too. Not safe for two threads at once.
class Scene {
 public:
  /// Reconstructs the base cloud. A cloud without normals is allowed: its scene has a mesh without triangles, and only
  /// orient and options can be applied, until there are normals.
  /// @throws Error as EditSession
  explicit Scene(Cloud base, SceneOptions options = {}, Workspace workspace = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  /// Appends an operation to those that are done, and forgets those that were undone. An interval of 0 in a Guide is
  /// written into the history as the number that was used.
  /// @throws Error as EditSession::apply, Deformer, Booleans, NormalEstimator and Reconstructor; usage for a Configure
  ///         out of range. The scene stays as it was
  const StepRecord& apply(const SceneOperation& operation);

  /// @returns false if there is nothing to undo, or to redo
  bool undo();
  bool redo();
  /// Makes the first `done` operations those that are done. On an error the scene stays as it was.
  /// @throws Error usage if there are not so many; as apply()
  void go_to(std::size_t done);

  [[nodiscard]] std::size_t done() const;
  [[nodiscard]] std::size_t size() const;                              ///< done and undone
  [[nodiscard]] const StepRecord& record(std::size_t i) const;         ///< i < size()
  [[nodiscard]] const SceneOperation& operation(std::size_t i) const;  ///< i < size()

  /// The present surface; without triangles as long as there are no normals.
  [[nodiscard]] const Mesh& mesh() const;
  /// The present points, with the attribute "added" (EditSession::cloud); the base as it came if it has no normals.
  [[nodiscard]] Cloud cloud() const;
  /// Those that the present surface is made with.
  [[nodiscard]] const Options& options() const;
  /// Of the present surface; zero without SceneOptions::topology.
  [[nodiscard]] Topology topology() const;
  /// What a guide, remove, flip or insert would add and remove (EditSession::preview); nothing changes.
  /// @throws Error as EditSession::preview; usage for any other operation
  [[nodiscard]] EditPreview preview(const SceneOperation& operation) const;

  [[nodiscard]] Workspace workspace() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointskin::scene
