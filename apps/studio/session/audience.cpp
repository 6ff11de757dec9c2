#include "audience.hpp"

#include <algorithm>
#include <utility>

namespace pointskin::studio {

void Audience::join(std::shared_ptr<Client> client) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t id = client->id();
  seats_[id] = {std::move(client), {}};
}

void Audience::leave(std::uint64_t client) {
  const std::lock_guard lock(mutex_);
  seats_.erase(client);
}

bool Audience::empty() const {
  const std::lock_guard lock(mutex_);
  return seats_.empty();
}

void Audience::tell(const Json& event) const {
  const std::string text = event.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::lock_guard lock(mutex_);
  for (const auto& [id, seat] : seats_) seat.client->send(text);
}

int Audience::show(const Json& event, bool may_drop) {
  const std::string text = event.dump(-1, ' ', false, Json::error_handler_t::replace);
  const auto version = event.at("version").get<std::uint64_t>();
  const std::lock_guard lock(mutex_);
  int told = 0;
  for (auto& [id, seat] : seats_) {
    if (may_drop && seat.undrawn.size() >= kMostUndrawn) continue;
    seat.undrawn.insert(version);
    seat.client->send(text);
    ++told;
  }
  return told;
}

bool Audience::somebody_waits() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(seats_.begin(), seats_.end(),
                     [](const auto& seat) { return seat.second.undrawn.size() < kMostUndrawn; });
}

void Audience::wait_until_drawn(std::uint64_t version, std::chrono::milliseconds most,
                                const std::function<bool()>& stop) const {
  constexpr std::chrono::milliseconds kLook{10};
  const auto draws = [version](const auto& seat) {
    const auto& undrawn = seat.second.undrawn;
    return undrawn.size() == 1 && undrawn.contains(version);
  };
  const auto end = std::chrono::steady_clock::now() + most;
  std::unique_lock lock(mutex_);
  while (std::any_of(seats_.begin(), seats_.end(), draws) && std::chrono::steady_clock::now() < end && !stop())
    drawn_.wait_for(lock, kLook);
}

void Audience::remember(const std::string& kind, std::vector<Json> events) {
  const std::lock_guard lock(mutex_);
  remembered_[kind] = std::move(events);
}

void Audience::remember_more(const std::string& kind, const Json& event) {
  const std::lock_guard lock(mutex_);
  remembered_[kind].push_back(event);
}

Json Audience::remembered(const std::string& kind) const {
  const std::lock_guard lock(mutex_);
  const auto found = remembered_.find(kind);
  return found == remembered_.end() || found->second.empty() ? Json(nullptr) : found->second.front();
}

void Audience::brief(Client& client) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [kind, events] : remembered_)
    for (const Json& event : events) client.send(event.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void Audience::drew(std::uint64_t client, std::uint64_t version) {
  const std::lock_guard lock(mutex_);
  const auto seat = seats_.find(client);
  if (seat == seats_.end()) return;
  auto& undrawn = seat->second.undrawn;
  undrawn.erase(undrawn.begin(), undrawn.upper_bound(version));
  drawn_.notify_all();
}

}  // namespace pointskin::studio
