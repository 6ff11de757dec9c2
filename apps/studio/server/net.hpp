// What the connections of the server share. Of these headers, net.hpp, body.hpp, http_connection.hpp, web_socket.hpp and
// listener.hpp, only server.cpp includes any: Boost is compiled once and named nowhere else.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <boost/asio.hpp>
#include <boost/beast.hpp>

#include "studio/server/guard.hpp"
#include "studio/server/server.hpp"

namespace pointskin::studio::server {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using net::ip::tcp;
using BoostError = boost::system::error_code;

/// To wait for an operation whose failure is looked at and not thrown.
inline auto into(BoostError& error) { return net::redirect_error(net::use_awaitable, error); }

/// A connection, to those who end it. Both may be called from any thread.
class Connection {
 public:
  Connection() = default;
  virtual ~Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual void say_goodbye() = 0;  ///< what can be told is told; the rest goes on
  virtual void cut() = 0;
};

/// All connections that are open.
class Connections {
 public:
  void add(const std::shared_ptr<Connection>& connection) {
    const std::lock_guard lock(mutex_);
    std::erase_if(all_, [](const auto& held) { return held.expired(); });
    all_.push_back(connection);
  }
  void each(void (Connection::*action)()) {
    std::vector<std::shared_ptr<Connection>> held;
    {
      const std::lock_guard lock(mutex_);
      for (const auto& connection : all_)
        if (auto alive = connection.lock()) held.push_back(std::move(alive));
    }
    for (const auto& connection : held) ((*connection).*action)();
  }

 private:
  std::mutex mutex_;
  std::vector<std::weak_ptr<Connection>> all_;
};

struct Shared {
  const ServerOptions& options;
  Application& application;
  Guard guard;
  net::thread_pool workers{2};  ///< for what may wait: the application's blobs, and files
  Connections connections{};
  std::atomic<int> open{0};     ///< connections that hold a Seat
  std::atomic<int> refused{0};  ///< connections that are told that there is none
  std::atomic<int> sockets{0};  ///< WebSockets among them
  std::atomic<std::uint64_t> next_id{1};
  std::atomic<bool> stopping{false};
};

/// One of a number of places, held while this lives.
class Seat {
 public:
  explicit Seat(std::atomic<int>& taken) : taken_(&taken), number_(++taken) {}
  ~Seat() {
    if (taken_ != nullptr) --*taken_;
  }
  Seat(Seat&& other) noexcept : taken_(std::exchange(other.taken_, nullptr)), number_(other.number_) {}
  Seat(const Seat&) = delete;
  Seat& operator=(const Seat&) = delete;
  Seat& operator=(Seat&&) = delete;
  [[nodiscard]] bool is_within(int most) const { return number_ <= most; }

 private:
  std::atomic<int>* taken_;
  int number_;
};

/// Runs `work` on a worker. Errors of it are thrown here.
template <class Work>
auto on_worker(Shared& shared, Work work) -> net::awaitable<decltype(work())> {
  auto task = [work = std::move(work)]() -> net::awaitable<decltype(work())> { co_return work(); };
  co_return co_await net::co_spawn(shared.workers, std::move(task), net::use_awaitable);
}

}  // namespace pointskin::studio::server
