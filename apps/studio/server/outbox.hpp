// The messages that wait for one page. What an Application holds of a page is this, which outlives the connection.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "studio/session/application.hpp"

namespace pointskin::studio::server {

class Outbox : public Client {
 public:
  /// @param most_bytes  that may wait; with more the page is given up
  /// @param wake        is called after every message that was added, under a lock, until close()
  Outbox(std::uint64_t id, bool loopback, std::int64_t most_bytes, std::function<void()> wake);

  void send(std::string json) override;
  [[nodiscard]] bool loopback() const override { return loopback_; }
  [[nodiscard]] std::uint64_t id() const override { return id_; }

  /// The message that waits longest; unset if none does.
  std::optional<std::string> next();
  /// The page did not read for so long that messages were lost.
  [[nodiscard]] bool overrun() const;
  /// From now on nothing is kept and `wake` is not called.
  void close();

 private:
  const std::uint64_t id_;
  const bool loopback_;
  const std::int64_t most_bytes_;
  mutable std::mutex mutex_;
  std::function<void()> wake_;  ///< empty: closed
  std::deque<std::string> waiting_;
  std::int64_t waiting_bytes_ = 0;
  bool overrun_ = false;
};

}  // namespace pointskin::studio::server
