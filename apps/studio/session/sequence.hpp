// The frames of a simulation that lie in files, as surfaces: those shown lately are kept, those that come next are made
// before they are asked for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <pointskin/fluid.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin::studio {

struct SequenceOptions {
  double particle_radius = 0;                       ///< world units; 0: half of the spacing of the first frame's points
  std::int64_t most_bytes = std::int64_t{1} << 30;  ///< of the frames that are kept
};

/// All calls from one thread.
class Sequence {
 public:
  /// @param files  the frames in their order (scene::find_frames), at least one; particles in any format of clouds
  /// @throws Error as read_cloud, if the first file cannot be read
  Sequence(std::vector<std::filesystem::path> files, const SequenceOptions& options, Workspace workspace);

  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(files_.size()); }
  [[nodiscard]] double particle_radius() const { return surface_.particle_radius; }
  [[nodiscard]] bool has(std::int64_t frame) const { return kept_.contains(frame); }

  /// The surface of a frame. It stays valid while somebody holds it.
  /// @throws Error usage if there is no such frame; as read_cloud and FluidSurfacer::surface
  std::shared_ptr<const Mesh> frame(std::int64_t frame);

  /// Makes the next frame behind `frame` that is not there yet, of those that would be kept; the first follows the last.
  /// @returns whether there was one
  bool make_ahead(std::int64_t frame);

 private:
  struct Kept {
    std::shared_ptr<const Mesh> mesh;
    std::list<std::int64_t>::iterator place;  ///< in lately_
  };

  [[nodiscard]] std::shared_ptr<const Mesh> make(std::int64_t frame);
  void forget_oldest();

  std::vector<std::filesystem::path> files_;
  FluidOptions surface_;
  std::int64_t most_bytes_;
  FluidSurfacer surfacer_;
  std::unordered_map<std::int64_t, Kept> kept_;
  std::list<std::int64_t> lately_;  ///< frames kept, the last used one first
  std::int64_t kept_bytes_ = 0;
};

}  // namespace pointskin::studio
