// A part of the points and a depth with which a surface is made while a person waits for the next move.
#pragma once

#include <cstdint>
#include <optional>

#include <pointskin/cloud.hpp>
#include <pointskin/reconstruct.hpp>

#include "scene_desk.hpp"

namespace pointskin::studio {

/// Made anew when the scene's points change: an even choice of them at depth 7 or 6, whatever takes under 100 ms here.
class PreviewCloud {
 public:
  PreviewCloud(Services& services, SceneDesk& desk) : services_(services), desk_(desk) {}

  /// Measures on first use after a change: a few reconstructions.
  const Cloud& cloud();
  /// Measures while nobody waits, so that the first move of a slider has its preview. @returns whether there was work
  bool prepare();
  /// The scene's options at the depth of previews, with points taken as they are.
  [[nodiscard]] Options options();

 private:
  static constexpr double kMostMs = 100;
  static constexpr std::int64_t kMostPoints = 400'000, kFewestPoints = 20'000;
  static constexpr int kDeepest = 7, kFlattest = 6;

  void refresh();
  [[nodiscard]] double measured_ms();

  Services& services_;
  SceneDesk& desk_;
  std::optional<std::uint64_t> state_;  ///< that the cloud was made of
  Cloud cloud_;
  int depth_ = kFlattest;
};

}  // namespace pointskin::studio
