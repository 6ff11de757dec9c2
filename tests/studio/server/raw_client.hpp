// Talks to a server byte by byte, as no browser would.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace pointskin::test {

/// What a server answered. Header names are in lower case.
struct Reply {
  int status = 0;  ///< 0: it closed the connection without a word
  std::map<std::string, std::string> headers;
  std::string body;

  [[nodiscard]] std::string header(const std::string& name) const;
};

/// A frame of a WebSocket.
struct Frame {
  int opcode = 0;  ///< 1 text, 2 binary, 8 close, 9 ping, 10 pong
  std::string payload;

  /// Of a close frame.
  [[nodiscard]] int close_code() const;
};

/// One TCP connection. Waits at most ten seconds for anything.
class RawClient {
 public:
  explicit RawClient(int port, const std::string& address = "127.0.0.1");
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  /// @returns whether the connection was still open for all of it
  bool send(std::string_view bytes);
  /// @param has_body  false: the answer to HEAD
  Reply receive(bool has_body = true);
  Reply ask(std::string_view request) { return send(request), receive(); }
  void send_frame(int opcode, std::string_view payload, bool masked = true, bool final = true);
  /// Unset: the connection was closed.
  std::optional<Frame> receive_frame();
  /// Waits for the other side to close. @returns how long that took; unset if it did not, within `limit`
  std::optional<std::chrono::milliseconds> closed_after(std::chrono::milliseconds limit);
  /// Closes so that the other side sees an error.
  void reset();

 private:
  bool fill(std::chrono::milliseconds limit);
  std::optional<std::string> take(std::size_t count);

  int socket_;
  std::string buffer_;
};

}  // namespace pointskin::test
