// The server of the studio: HTTP and WebSocket on this machine, for pages that know a token. Serves an Application and
// knows nothing of what it does. Decisions: docs/decisions/0039-studio-server.md.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studio/session/application.hpp"

namespace pointskin::studio::server {

/// A file of the page.
struct Asset {
  std::span<const std::byte> bytes;
  std::string type;  ///< of its content, such as "text/html; charset=utf-8"
  std::string etag;  ///< in quotes; other bytes have another one
};

/// What one page, or who pretends to be one, may take of the server.
struct Limits {
  std::int64_t header_bytes = 8 * 1024;
  std::int64_t message_bytes = 1 << 20;  ///< of a WebSocket message, from the page
  std::int64_t outbox_bytes = 16 << 20;  ///< that wait for a page which does not read; it is dropped then
  int connections = 16;
  std::chrono::milliseconds header_time{10'000};   ///< from the first byte of a header to its last
  std::chrono::milliseconds block_time{20'000};    ///< for 256 KiB of a body, either way
  std::chrono::milliseconds idle_time{60'000};     ///< between two requests
  std::chrono::milliseconds silence_time{60'000};  ///< of a WebSocket; a ping is sent after half of it
  std::chrono::milliseconds closing_time{2'000};   ///< for pages to answer when the server closes
};

struct ServerOptions {
  std::vector<std::string> hosts{"127.0.0.1",
                                 "::1"};  ///< to listen on, and names that requests may give; the first must be there
  int port = 0;                           ///< the same for all hosts; 0: any that is free
  std::string token{};                    ///< empty: a random one of 128 bits
  std::int64_t max_upload = std::int64_t{4} << 30;  ///< bytes
  /// The file of the page with this name, such as "index.html"; unset if there is none. Called from any thread.
  std::function<std::optional<Asset>(std::string_view name)> assets{};
  Limits limits{};
};

/// Listens from when it is made, so that its address is known, and answers while run() runs.
class Server {
 public:
  /// @param application  must outlive the server
  /// @throws Error output_not_written if the port is taken, usage for a host that is not of this machine
  Server(ServerOptions options, Application& application);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] int port() const;
  /// "http://127.0.0.1:8123/#" and the token.
  [[nodiscard]] std::string url() const;
  /// The same with a secret that is good for one page, to start a browser with.
  [[nodiscard]] std::string url_for_browser() const;

  /// Answers requests until stop(). To be called once.
  void run();
  /// Closes in order: nothing new is accepted, pages are told, then the rest is cut. From any thread; returns at once.
  void stop();

 private:
  class Running;
  std::unique_ptr<Running> running_;
};

}  // namespace pointskin::studio::server
