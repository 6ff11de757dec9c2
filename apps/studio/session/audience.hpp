// All pages that are connected: what they are told, and how far behind each is.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

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

  /// A page has drawn a version, and so all before it.
  void drew(std::uint64_t client, std::uint64_t version);

 private:
  struct Seat {
    std::shared_ptr<Client> client;
    std::set<std::uint64_t> undrawn;  ///< versions told
  };

  mutable std::mutex mutex_;
  std::map<std::uint64_t, Seat> seats_;
};

}  // namespace pointskin::studio
