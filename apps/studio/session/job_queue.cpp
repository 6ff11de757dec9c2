#include "job_queue.hpp"

#include <algorithm>
#include <utility>

namespace pointskin::studio {

bool JobQueue::push(Job job) {
  std::deque<Job> dropped;
  {
    const std::lock_guard lock(mutex_);
    if (closed_ || jobs_.size() >= kMostJobs) return false;
    if (!job.slot.empty()) {
      const auto older = std::stable_partition(jobs_.begin(), jobs_.end(),
                                               [&job](const Job& waiting) { return waiting.slot != job.slot; });
      std::move(older, jobs_.end(), std::back_inserter(dropped));
      jobs_.erase(older, jobs_.end());
    }
    jobs_.push_back(std::move(job));
  }
  changed_.notify_one();
  for (const Job& old : dropped) refuse(old.request, "superseded", "a newer request took its place");
  return true;
}

std::optional<JobQueue::Job> JobQueue::next(std::chrono::milliseconds wait) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, wait, [this] { return closed_ || !jobs_.empty(); });
  if (closed_ || jobs_.empty()) return std::nullopt;
  auto first = std::find_if(jobs_.begin(), jobs_.end(), [](const Job& job) { return !job.background; });
  if (first == jobs_.end()) first = jobs_.begin();
  Job job = std::move(*first);
  jobs_.erase(first);
  running_ = job.slot;
  runs_background_ = job.background;
  cancelled_ = false;
  return job;
}

void JobQueue::finished() {
  const std::lock_guard lock(mutex_);
  running_.reset();
  cancelled_ = false;
}

bool JobQueue::put_back(Job job) {
  const std::lock_guard lock(mutex_);
  const auto is_newer = [&job](const Job& waiting) { return waiting.slot == job.slot; };
  if (closed_ || cancelled_ || std::any_of(jobs_.begin(), jobs_.end(), is_newer)) return false;
  jobs_.push_back(std::move(job));
  return true;
}

bool JobQueue::should_stop() const {
  const std::lock_guard lock(mutex_);
  if (closed_ || cancelled_) return true;
  if (!running_ || running_->empty()) return false;
  return std::any_of(jobs_.begin(), jobs_.end(), [this](const Job& job) {
    return job.slot.empty() || job.slot == *running_ || (runs_background_ && !job.background);
  });
}

bool JobQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return closed_ || std::any_of(jobs_.begin(), jobs_.end(), [](const Job& job) { return !job.background; });
}

bool JobQueue::waiting(const std::string& slot) const {
  const std::lock_guard lock(mutex_);
  return std::any_of(jobs_.begin(), jobs_.end(), [&slot](const Job& job) { return job.slot == slot; });
}

void JobQueue::cancel() {
  const std::lock_guard lock(mutex_);
  cancelled_ = running_.has_value();
}

void JobQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

bool JobQueue::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

}  // namespace pointskin::studio
