// A connection that speaks WebSocket: messages of a page to the application, and back.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "studio/server/answers.hpp"
#include "studio/server/net.hpp"
#include "studio/server/outbox.hpp"

namespace pointskin::studio::server {

/// A stream whose end is not waited for longer than a while: Beast would wait until the other side closes, too.
class PageStream : public beast::tcp_stream {
 public:
  PageStream(beast::tcp_stream stream, std::chrono::milliseconds patience)
      : beast::tcp_stream(std::move(stream)), timer_(get_executor()), patience_(patience) {}

  /// Beast calls this when a WebSocket has ended.
  template <class Handler>
  friend void async_teardown(beast::role_type role, PageStream& stream, Handler&& handler) {
    stream.timer_.expires_after(stream.patience_);
    stream.timer_.async_wait([&stream](BoostError error) {
      if (!error) stream.close();
    });
    websocket::async_teardown(role, stream.socket(), std::forward<Handler>(handler));
  }

 private:
  net::steady_timer timer_;
  std::chrono::milliseconds patience_;
};

class WebSocket : public Connection, public std::enable_shared_from_this<WebSocket> {
 public:
  WebSocket(Shared& shared, beast::tcp_stream stream, bool loopback)
      : shared_(shared),
        socket_(std::move(stream), shared.options.limits.closing_time),
        wake_(socket_.get_executor()),
        seat_(shared.sockets),
        loopback_(loopback) {}

  ~WebSocket() override {
    if (outbox_ != nullptr && !ended_) end();
  }

  void say_goodbye() override {
    net::post(socket_.get_executor(), [self = shared_from_this()] { self->close(websocket::close_code::going_away); });
  }
  void cut() override {
    net::post(socket_.get_executor(), [self = shared_from_this()] { self->hang_up(); });
  }

  /// Until the page is gone. @param request  that asked for it
  template <class Message>
  net::awaitable<void> run(const Message& request) {
    prepare();
    BoostError error;
    co_await socket_.async_accept(request, into(error));
    if (error) co_return hang_up();
    accepted_ = true;
    const auto wake = [weak = weak_from_this()] {
      if (const auto self = weak.lock()) net::post(self->socket_.get_executor(), [self] { self->look_at_outbox(); });
    };
    outbox_ = std::make_shared<Outbox>(shared_.next_id++, loopback_, shared_.options.limits.outbox_bytes, wake);
    shared_.application.opened(outbox_);
    net::co_spawn(
        socket_.get_executor(), [self = shared_from_this()] { return self->write_all(); }, net::detached);
    co_await read_all();
    end();
    wake_.cancel();
    hang_up();
  }

 private:
  void prepare() {
    const Limits& limits = shared_.options.limits;
    websocket::stream_base::timeout times;
    times.handshake_timeout = limits.closing_time;
    times.idle_timeout = limits.silence_time;
    times.keep_alive_pings = true;
    socket_.set_option(times);
    socket_.auto_fragment(false);
    socket_.read_message_max(static_cast<std::size_t>(limits.message_bytes));
    socket_.set_option(websocket::stream_base::decorator([](websocket::response_type& answer) {
      for (const auto& [name, value] : fields_of_every_answer()) answer.set(name, value);
      answer.set(http::field::cache_control, "no-store");
    }));
  }

  net::awaitable<void> read_all() {
    beast::flat_buffer buffer;
    for (;;) {
      BoostError error;
      co_await socket_.async_read(buffer, into(error));
      if (error) break;  // gone, silent, or what came is no WebSocket: Beast has told it so
      if (!socket_.got_text()) {
        if (!std::exchange(closing_, true))
          co_await socket_.async_close(websocket::close_code::unknown_data, into(error));
        break;
      }
      const auto bytes = buffer.cdata();
      shared_.application.message(outbox_, {static_cast<const char*>(bytes.data()), bytes.size()});
      buffer.consume(buffer.size());
    }
  }

  void look_at_outbox() {
    if (outbox_->overrun()) hang_up();
    wake_.cancel();
  }

  /// Sleeps until the outbox wakes it.
  net::awaitable<void> write_all() {
    BoostError error;
    while (!ended_ && !error) {
      const std::optional<std::string> message = outbox_->next();
      if (message) {
        socket_.text(true);
        co_await socket_.async_write(net::buffer(*message), into(error));
      } else {
        BoostError woken;
        wake_.expires_at(net::steady_timer::time_point::max());
        co_await wake_.async_wait(into(woken));
      }
    }
  }

  void close(websocket::close_code code) {
    if (!accepted_) return hang_up();  // what is said now would get between the bytes of the handshake
    if (std::exchange(closing_, true)) return;
    socket_.async_close(code, [self = shared_from_this()](BoostError) {});
  }

  void end() {
    ended_ = true;
    outbox_->close();
    shared_.application.closed(outbox_->id());
  }

  void hang_up() { beast::get_lowest_layer(socket_).close(); }

  Shared& shared_;
  websocket::stream<PageStream> socket_;
  net::steady_timer wake_;
  const Seat seat_;
  const bool loopback_;
  bool accepted_ = false, ended_ = false, closing_ = false;
  std::shared_ptr<Outbox> outbox_;
};

}  // namespace pointskin::studio::server
