// What an operation or an option would do, shown before it is done: quickly, and without a trace in the scene.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <pointskin/boolean.hpp>
#include <pointskin/deform.hpp>

#include "mesh_teller.hpp"
#include "preview_cloud.hpp"
#include "scene_desk.hpp"

namespace pointskin::studio {

/// Functions may throw Error; those of the library are cancelled where a newer request waits. Of the engine's thread.
class Previews {
 public:
  Previews(Services& services, SceneDesk& desk, MeshTeller& teller)
      : services_(services), desk_(desk), teller_(teller), cloud_(services, desk) {}

  /// Guide, remove, flip, insert: ghosts. Deform, boolean: a mesh.
  Json operation(const nlohmann::json& operation);
  /// A mesh with other options. @param patch  as of the operation `options`
  Json options(const nlohmann::json& patch);
  /// Back to what is.
  Json end();
  /// Work that makes the first preview quick. @returns whether there was some
  bool prepare() { return cloud_.prepare(); }
  /// Frees what is kept from one move of a drag to the next.
  void forget();

 private:
  Json points(const scene::SceneOperation& operation);
  Json bent(const scene::Deform& deform);
  Json combined(const scene::Combine& combine);
  /// The depth and cloud of a drag: all points where the engine is fast enough for that.
  void prepare_deformer();
  Json show(const Mesh& mesh, int depth, double ms);

  /// Twenty meshes a second.
  static constexpr double kFastEnoughMs = 45;

  Services& services_;
  SceneDesk& desk_;
  MeshTeller& teller_;
  PreviewCloud cloud_;
  std::unique_ptr<Deformer> deformer_;
  std::optional<std::uint64_t> deformer_state_;
  int deformer_depth_ = 0;
  Mesh mesh_;
  bool is_shown_ = false;
};

}  // namespace pointskin::studio
