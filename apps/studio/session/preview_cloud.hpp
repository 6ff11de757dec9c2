// A part of the points and a depth with which a surface is made while a person waits for the next move.
#pragma once

#include <cstdint>
#include <optional>

#include <pointskin/cloud.hpp>
#include <pointskin/reconstruct.hpp>

#include "scene_desk.hpp"

namespace pointskin::studio {

/// Made anew when the scene's points change: an even choice of them at depth 7 or 6, whatever takes under 100 ms here.
/// That is measured once for clouds of about one size.
class PreviewCloud {
 public:
  PreviewCloud(Services& services, SceneDesk& desk) : services_(services), desk_(desk) {}

  /// What is small enough for any machine, before it was measured what this one can do.
  const Cloud& cloud();
  /// Measures while nobody waits: reconstructions that take about half a second together, and end as soon as something
  /// is asked for. @returns whether there was work
  bool prepare();
  /// The scene's options at the depth of previews, with points taken as they are.
  [[nodiscard]] Options options();

 private:
  static constexpr double kMostMs = 100;
  static constexpr std::int64_t kMostPoints = 400'000, kFirstPoints = 50'000, kFewestPoints = 20'000;
  static constexpr int kDeepest = 7, kFlattest = 6;

  void refresh();
  bool is_measured_for(std::int64_t points) const;
  /// Finds how many points of `whole`, and which depth. @param whole  without attributes
  void measure(const Cloud& whole);
  /// Takes so many points of `whole` and reconstructs them. @returns milliseconds
  double tried(const Cloud& whole, std::int64_t points, int depth);

  Services& services_;
  SceneDesk& desk_;
  std::optional<std::uint64_t> state_;  ///< that the cloud was made of
  Cloud cloud_;
  std::int64_t points_ = 0;  ///< of cloud_, at most
  int depth_ = kFlattest;
  std::int64_t measured_size_ = 0;  ///< of the cloud that this was measured with; 0: none yet
  bool is_final_ = false;           ///< cloud_ is as large as was measured
};

}  // namespace pointskin::studio
