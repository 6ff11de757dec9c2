// All pages that are connected: what they are told, and how far behind each is.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "requests.hpp"

namespace pointskin::studio {

/// A page that has not yet drawn two meshes that it was told of gets no further preview or frame; meshes that count are
/// told to all. All functions may be called from any thread.
class Audience {
 public:
  static constexpr int kMostUndrawn = 2;

  void join(std::shared_ptr<Client> client);
  void leave(std::uint64_t client);
  [[nodiscard]] bool empty() const;

  /// Tells all pages.
  void tell(const Json& event) const;

  /// Tells of a mesh; where `may_drop`, only pages that keep up. @param event  with "version"
  /// @returns how many were told
  int show(const Json& event, bool may_drop);
  /// Whether show(.., true) would tell anybody.
  [[nodiscard]] bool somebody_waits() const;

  /// Waits until the pages have drawn a version: a browser on this machine needs the processor as much as the engine.
  /// Pages that had not drawn the one before are not waited for: nobody looks at them.
  /// @param stop  asked now and then; ends it
  void wait_until_drawn(std::uint64_t version, std::chrono::milliseconds most, const std::function<bool()>& stop) const;

  /// What a page that comes later is told first: the newest events of each kind. Replaces those before.
  void remember(const std::string& kind, std::vector<Json> events);
  void remember_more(const std::string& kind, const Json& event);
  /// Of a kind that has one event; null if there is none.
  [[nodiscard]] Json remembered(const std::string& kind) const;
  /// Tells a page all that is remembered.
  void brief(Client& client) const;

  /// A page has drawn a version, and so all before it.
  void drew(std::uint64_t client, std::uint64_t version);

 private:
  struct Seat {
    std::shared_ptr<Client> client;
    std::set<std::uint64_t> undrawn;  ///< versions told
  };

  mutable std::mutex mutex_;
  mutable std::condition_variable drawn_;
  std::map<std::uint64_t, Seat> seats_;
  std::map<std::string, std::vector<Json>> remembered_;
};

}  // namespace pointskin::studio
