#include "scene/history.hpp"

#include <utility>

namespace pointskin::scene {

void History::append(std::size_t done, Step step) {
  steps_.resize(done);
  steps_.push_back(std::move(step));
}

std::size_t History::stage_begin(std::size_t done) const {
  while (done > 0 && is_edit(steps_[done - 1].operation)) --done;
  return done;
}

std::size_t History::kept_begin(std::size_t begin) const {
  while (begin > 0 && steps_[begin - 1].stage == nullptr) --begin;
  return begin;
}

const std::shared_ptr<const Stage>& History::stage(std::size_t begin) const {
  return begin == 0 ? base_ : steps_[begin - 1].stage;
}

void History::fit(std::size_t done, std::int64_t bytes) {
  std::int64_t held = 0;
  for (const Step& step : steps_)
    if (step.stage != nullptr) held += bytes_of(*step.stage);
  const auto distance = [done](std::size_t begin) { return begin > done ? begin - done : done - begin; };
  while (held > bytes) {
    std::size_t farthest = 0;
    for (std::size_t begin = 1; begin <= steps_.size(); ++begin)
      if (stage(begin) != nullptr && (farthest == 0 || distance(begin) > distance(farthest))) farthest = begin;
    held -= bytes_of(*stage(farthest));
    steps_[farthest - 1].stage = nullptr;
  }
}

}  // namespace pointskin::scene
