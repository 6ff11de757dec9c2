// The operations of a scene, and the stages between them that are kept for undo.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "scene/operations.hpp"
#include "scene/scene.hpp"
#include "scene/stage.hpp"

namespace pointskin::scene {

struct Step {
  SceneOperation operation;
  StepRecord record;
  std::shared_ptr<const Stage> stage;  ///< that the operation made; null for those of a session, and where forgotten
};

class History {
 public:
  /// @param base  of the scene, always kept
  explicit History(std::shared_ptr<const Stage> base) : base_(std::move(base)) {}

  [[nodiscard]] std::size_t size() const { return steps_.size(); }
  [[nodiscard]] const Step& step(std::size_t i) const { return steps_.at(i); }

  /// Forgets all but the first `done` steps and adds one.
  void append(std::size_t done, Step step);

  /// The last place, at most `done`, where a stage begins: after a step that makes one, or 0.
  [[nodiscard]] std::size_t stage_begin(std::size_t done) const;
  /// The last place, at most `begin`, whose stage is kept.
  [[nodiscard]] std::size_t kept_begin(std::size_t begin) const;
  /// The stage there; null where it is not kept.
  [[nodiscard]] const std::shared_ptr<const Stage>& stage(std::size_t begin) const;
  /// Keeps a stage that was made again. @param begin  at least 1
  void keep(std::size_t begin, std::shared_ptr<const Stage> stage) { steps_[begin - 1].stage = std::move(stage); }

  /// Forgets stages, those farthest from `done` first, until the others take no more than `bytes`.
  void fit(std::size_t done, std::int64_t bytes);

 private:
  std::shared_ptr<const Stage> base_;
  std::vector<Step> steps_;
};

}  // namespace pointskin::scene
