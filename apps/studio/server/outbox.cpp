#include "studio/server/outbox.hpp"

#include <utility>

namespace pointskin::studio::server {

Outbox::Outbox(std::uint64_t id, bool loopback, std::int64_t most_bytes, std::function<void()> wake)
    : id_(id), loopback_(loopback), most_bytes_(most_bytes), wake_(std::move(wake)) {}

void Outbox::send(std::string json) {
  const std::lock_guard lock(mutex_);
  if (!wake_ || overrun_) return;
  waiting_bytes_ += static_cast<std::int64_t>(json.size());
  overrun_ = waiting_bytes_ > most_bytes_;
  if (overrun_)
    waiting_.clear();
  else
    waiting_.push_back(std::move(json));
  wake_();
}

std::optional<std::string> Outbox::next() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  std::string message = std::move(waiting_.front());
  waiting_.pop_front();
  waiting_bytes_ -= static_cast<std::int64_t>(message.size());
  return message;
}

bool Outbox::overrun() const {
  const std::lock_guard lock(mutex_);
  return overrun_;
}

void Outbox::close() {
  const std::lock_guard lock(mutex_);
  wake_ = nullptr;
  waiting_.clear();
}

}  // namespace pointskin::studio::server
