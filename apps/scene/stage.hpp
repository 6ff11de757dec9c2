// What deform, boolean, orient and options make: the points and the surface that the next editing session begins with.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

#include "scene/operations.hpp"
#include "scene/scene.hpp"

namespace pointskin::scene {

/// Never changed once it is made.
struct Stage {
  std::shared_ptr<const Cloud> cloud;  ///< of a session that goes on: with the attribute "added"
  std::shared_ptr<const Mesh> mesh;    ///< null: that of a session without operations
  Options options;                     ///< as the scene shows them
  bool continued = false;              ///< EditOptions::continued

  [[nodiscard]] bool has_surface() const { return cloud->has_normals(); }
};

/// Host memory of cloud and mesh.
std::int64_t bytes_of(const Stage& stage);

/// The options that a stage's points are reconstructed with: strays of a cloud that goes on stay, and its normals are
/// taken as given.
Options settled_options(const Stage& stage, const std::function<bool(const Progress&)>& progress);

/// What making a stage needs besides the operation.
struct StageMaker {
  Workspace workspace;
  std::function<bool(const Progress&)> progress;

  /// @param before  cloud, options and `continued` of the state before; its mesh does not count
  /// @param operation  none of an editing session (is_edit)
  /// @param record  receives points, triangles, what was added and removed, times and notes
  /// @throws Error as Scene::apply
  [[nodiscard]] Stage make(const Stage& before, const SceneOperation& operation, StepRecord& record) const;

 private:
  [[nodiscard]] Stage make_from(const Stage& before, const Deform& deform, StepRecord& record) const;
  [[nodiscard]] Stage make_from(const Stage& before, const Combine& combine, StepRecord& record) const;
  [[nodiscard]] Stage make_from(const Stage& before, const Orient& orient, StepRecord& record) const;
  [[nodiscard]] Stage make_from(const Stage& before, const Configure& configure, StepRecord& record) const;
  [[nodiscard]] std::shared_ptr<const Mesh> reconstruct(const Stage& stage, StepRecord& record) const;
};

}  // namespace pointskin::scene
