#include "scene/segment.hpp"

#include <utility>

#include <pointskin/error.hpp>

namespace pointskin::scene {

void Segment::settle(const SceneOptions& options, const Workspace& workspace) {
  if (session_ || !stage_->has_surface()) return;
  EditOptions edit;
  edit.reconstruction = settled_options(*stage_, options.progress);
  edit.warm_start = options.warm_start;
  edit.topology = false;  // the scene measures what it shows, stages too
  edit.continued = stage_->continued;
  edit.keep_attributes = true;
  session_.emplace(*stage_->cloud, edit, workspace);
}

void Segment::require_session() const {
  if (!session_) throw Error(ErrorCode::no_normals, "the points have no normals; estimate them first (orient)");
}

const StepReport& Segment::apply(const Operation& operation) {
  require_session();
  const StepReport& report = session_->apply(operation);
  known_ = ++done_;
  return report;
}

EditPreview Segment::preview(const Operation& operation) const {
  require_session();
  return session_->preview(operation);
}

void Segment::undo() {
  session_->undo();
  --done_;
}

bool Segment::redo() {
  if (done_ == known_) return false;
  session_->redo();
  ++done_;
  return true;
}

const Mesh& Segment::mesh() const {
  const bool is_of_stage = done_ == 0 && stage_->mesh != nullptr;
  return is_of_stage || !session_ ? *stage_->mesh : session_->mesh();
}

Cloud Segment::cloud() const {
  const bool is_of_stage = done_ == 0 && stage_->continued;
  return is_of_stage || !session_ ? *stage_->cloud : session_->cloud();
}

}  // namespace pointskin::scene
