// The scene that is worked on: what is done to it, its journal, and what pages are told of it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

#include "mesh_teller.hpp"
#include "progress_teller.hpp"
#include "scene/document.hpp"
#include "scene/journal.hpp"
#include "scene/scene.hpp"
#include "scene/sources.hpp"
#include "services.hpp"

namespace pointskin::studio {

/// All functions but the constructor may throw Error; the scene then stays as it was. Of the engine's thread.
class SceneDesk {
 public:
  SceneDesk(Services& services, MeshTeller& teller)
      : services_(services), teller_(teller), sources_(services.device.threads) {}

  /// Begins a scene and its journal. What the document says is done is done.
  /// @param journal  file; one that is there is replaced
  void begin(const scene::Document& document, const std::filesystem::path& journal);
  /// Goes on with the scene of a journal.
  void resume(const std::filesystem::path& journal);

  /// @param operation  a document's; files have absolute paths. @returns what it did, once it is on the disk
  Json apply(const nlohmann::json& operation);
  /// Undoes and redoes until `done` operations are done.
  Json go(std::size_t done);

  [[nodiscard]] bool has_scene() const { return scene_ != nullptr; }
  /// @throws Error usage if there is none yet
  [[nodiscard]] const scene::Scene& present() const;
  [[nodiscard]] scene::Document document() const;
  /// An operation of a message as the scene has it. @throws Error
  [[nodiscard]] scene::SceneOperation operation_of(const nlohmann::json& operation);

  /// The event `state`.
  [[nodiscard]] Json state() const;
  void tell_state() const;
  /// Shows the present mesh, as after an operation; at a lower depth if it has too many triangles.
  void show_mesh(Json ms = Json::object());
  /// The mesh that pages are shown, and its depth.
  [[nodiscard]] const Mesh& shown() const { return coarse_ ? *coarse_ : present().mesh(); }
  [[nodiscard]] int shown_depth() const { return coarse_ ? coarse_depth_ : present().options().depth; }
  /// Work that may wait until nobody does: the points. @returns whether there was some
  bool work_ahead();

  /// Counts states: what was measured of one does not hold for the next.
  [[nodiscard]] std::uint64_t state_number() const { return state_number_; }
  /// Milliseconds of the last reconstruction.
  [[nodiscard]] double last_ms() const { return last_ms_; }

 private:
  /// Facts of the present points.
  struct Points {
    std::int64_t count = 0;
    Bounds box{};  ///< relative to the origin
    Vec3d origin{};
    bool has_normals = false;
  };
  struct Opened {
    std::unique_ptr<scene::Scene> scene;
    Points points;
    std::vector<std::string> notices;
    std::int64_t dropped = 0;
  };

  static Points facts_of(const Cloud& cloud);

  [[nodiscard]] Opened open(const scene::Document& document, const std::filesystem::path& journal);
  void replay(const scene::Document& document, scene::Scene& scene);
  void show_again();
  void take(Opened opened, const scene::Document& document);
  void changed(Json ms);
  [[nodiscard]] const MeshReport& surface() const;
  void make_coarse();
  void measure_surface();
  [[nodiscard]] Json entry(std::size_t i) const;
  [[nodiscard]] Json record_json(std::size_t i) const;
  [[nodiscard]] Json surface_json() const;
  [[nodiscard]] Json topology_json(std::size_t state) const;

  Services& services_;
  MeshTeller& teller_;
  scene::Sources sources_;
  std::unique_ptr<scene::Scene> scene_;
  std::optional<scene::Journal> journal_;
  scene::Base base_;
  Options first_options_;
  std::int64_t dropped_ = 0;
  std::optional<Mesh> coarse_;  ///< what is shown of a surface with too many triangles
  int coarse_depth_ = 0;
  std::vector<std::optional<MeshReport>> surfaces_;  ///< of every state that was seen, by the operations done
  Points points_;                                    ///< where points_are_old_, the box is that of the state before
  std::int64_t base_points_ = 0;
  bool points_are_old_ = false;
  double last_ms_ = 0;
  std::uint64_t state_number_ = 0;
  ProgressTeller* progress_ = nullptr;  ///< of the running job
};

}  // namespace pointskin::studio
