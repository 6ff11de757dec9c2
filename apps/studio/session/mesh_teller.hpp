// Meshes and points on their way to pages: encoded, stored as blobs, announced.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

#include "services.hpp"
#include "studio/wire/wire.hpp"

namespace pointskin::studio {

/// What is said of a mesh beside its size.
struct MeshFacts {
  bool preview = false;             ///< shown for the while, and dropped for pages that lag behind
  int depth = 0;                    ///< of the octree; 0: none
  std::int64_t full_triangles = 0;  ///< of the mesh that saving writes; 0: this one
  Json ms = Json::object();         ///< what the stages took
  std::vector<wire::Values> values{};
  std::vector<std::uint8_t> tint{};
};

class MeshTeller {
 public:
  explicit MeshTeller(Services& services) : services_(services) {}

  /// What is told from now on belongs to this scene: pages show the first of it whole, and keep their view after that.
  void begin(std::string scene) { scene_ = std::move(scene); }
  [[nodiscard]] const std::string& scene() const { return scene_; }

  /// @returns its version; 0 if no page was told
  std::uint64_t show(const Mesh& mesh, const MeshFacts& facts);

  /// Of the newest mesh or frame.
  [[nodiscard]] std::uint64_t version() const { return version_; }

  /// A frame of water or of a sequence. @param facts  what its event says beside the blob
  /// @returns false if no page keeps up; nothing was encoded then
  bool show_frame(const Mesh& mesh, Json facts);

  /// The points of a cloud, in parts of which every beginning is an even choice: 200,000 first, at most `most_points` in
  /// all.
  void show_points(const Cloud& cloud, std::int64_t most_points);

  /// Points that an operation would add, and those that it would remove.
  void show_ghosts(const Cloud& added, const Cloud& removed);
  /// Points with a class each. @param tint  shape (n)
  void show_tinted(const Cloud& cloud, std::vector<std::uint8_t> tint, Json facts);
  void hide_ghosts();

 private:
  std::uint64_t announce(Json event, bool may_drop);

  Services& services_;
  std::uint64_t version_ = 0;
  std::string scene_;  ///< empty: none yet
};

}  // namespace pointskin::studio
