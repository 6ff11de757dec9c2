// A stretch of a scene's history: a stage, and an editing session that goes on from it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include <pointskin/edit.hpp>

#include "scene/scene.hpp"
#include "scene/stage.hpp"

namespace pointskin::scene {

/// The session is made when it is needed first, so that options can be changed again and again without one.
class Segment {
 public:
  /// @param begin  how many operations of the scene are done at the stage
  Segment(std::shared_ptr<const Stage> stage, std::size_t begin) : stage_(std::move(stage)), begin_(begin) {}

  [[nodiscard]] const std::shared_ptr<const Stage>& stage() const { return stage_; }
  [[nodiscard]] std::size_t begin() const { return begin_; }
  /// Operations of the scene that are done.
  [[nodiscard]] std::size_t done() const { return begin_ + done_; }

  /// Makes the session, if there is none and the points have normals. @throws Error as EditSession
  void settle(const SceneOptions& options, const Workspace& workspace);

  /// @throws Error as EditSession::apply; no_normals
  const StepReport& apply(const Operation& operation);
  /// The operation that was applied last, with numbers where it had none.
  [[nodiscard]] Operation last() const { return session_->operations().back(); }
  [[nodiscard]] EditPreview preview(const Operation& operation) const;
  [[nodiscard]] bool has_session() const { return session_.has_value(); }
  void undo();
  /// Goes one operation on, of those that were undone. @returns false if the session does not know it
  bool redo();

  [[nodiscard]] const Mesh& mesh() const;
  [[nodiscard]] Cloud cloud() const;

 private:
  void require_session() const;

  std::shared_ptr<const Stage> stage_;
  std::size_t begin_;
  std::optional<EditSession> session_;
  std::size_t done_ = 0;
  std::size_t known_ = 0;  ///< operations that the session has, done and undone
};

}  // namespace pointskin::scene
