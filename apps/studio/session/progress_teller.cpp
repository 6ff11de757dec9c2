#include "progress_teller.hpp"

#include <utility>

namespace pointskin::studio {
namespace {

constexpr std::chrono::milliseconds kQuiet{150}, kPause{50};

}  // namespace

ProgressTeller::ProgressTeller(Services& services, std::string job) : services_(services), job_(std::move(job)) {}

ProgressTeller::~ProgressTeller() {
  if (has_told_) services_.audience.tell({{"event", "progress"}, {"job", job_}, {"finished", true}});
}

bool ProgressTeller::operator()(const Progress& progress) {
  const Clock::time_point now = Clock::now();
  if (phases_.empty() || phases_.back().first != progress.phase) phases_.emplace_back(progress.phase, now);
  if (now - start_ >= kQuiet && now - told_ >= kPause) {
    told_ = now;
    has_told_ = true;
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    Json event = {{"event", "progress"}, {"job", job_}, {"phase", progress.phase}, {"fraction", progress.fraction}};
    event["eta_ms"] = progress.fraction > 0 ? Json(ms * (1 - progress.fraction) / progress.fraction) : Json(nullptr);
    services_.audience.tell(event);
  }
  return !services_.queue.should_stop();
}

Json ProgressTeller::phase_ms() const {
  Json phases = Json::object();
  for (std::size_t i = 0; i < phases_.size(); ++i) {
    const auto& [name, begin] = phases_[i];
    const Clock::time_point end = i + 1 < phases_.size() ? phases_[i + 1].second : Clock::now();
    phases[name] = phases.value(name, 0.0) + std::chrono::duration<double, std::milli>(end - begin).count();
  }
  return phases;
}

}  // namespace pointskin::studio
