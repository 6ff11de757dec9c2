// What moves by itself: water that is simulated, and frames of a sequence.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "mesh_teller.hpp"
#include "sequence.hpp"
#include "services.hpp"
#include "water.hpp"

namespace pointskin::studio {

/// Frames are dropped, never queued: none is made while pages still draw. Of the engine's thread.
class Live {
 public:
  Live(Services& services, MeshTeller& teller) : services_(services), teller_(teller) {}

  /// The request `fluid`. @throws Error
  Json fluid(const Request& request);
  /// The request `sequence`; paths are absolute. @throws Error
  Json open_sequence(const std::filesystem::path& pattern, double particle_radius);
  Json close_sequence();
  /// The request `frame`. @throws Error
  Json frame(std::int64_t index);

  /// The next frame of the water, or of the sequence before it is asked for.
  /// @returns whether there is more to do as soon as possible
  bool work_ahead();
  void stop() { water_.reset(), sequence_.reset(); }
  [[nodiscard]] bool is_running() const { return (water_ != nullptr && !paused_) || sequence_ != nullptr; }

 private:
  Json start(const scene::JsonReader& reader);
  bool next_frame();

  Services& services_;
  MeshTeller& teller_;
  std::unique_ptr<Water> water_;
  bool paused_ = false;
  bool free_ = false;  ///< as fast as frames can be made, not as fast as the simulated time
  std::chrono::steady_clock::time_point due_{};
  std::unique_ptr<Sequence> sequence_;
  std::int64_t shown_ = 0;  ///< frame of the sequence
};

}  // namespace pointskin::studio
