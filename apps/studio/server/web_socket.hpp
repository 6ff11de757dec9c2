// A connection that speaks WebSocket: messages of a page to the application, and back.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "studio/server/answers.hpp"
#include "studio/server/net.hpp"
#include "studio/server/outbox.hpp"

namespace pointskin::studio::server {

/// A stream that says when its WebSocket has ended. Beast then waits until the other side closes, too, however long.
class PageStream : public beast::tcp_stream {
 public:
  PageStream(beast::tcp_stream stream, std::function<void()> on_end)
      : beast::tcp_stream(std::move(stream)), on_end_(std::move(on_end)) {}

  /// Called by Beast.
  template <class Handler>
  friend void async_teardown(beast::role_type role, PageStream& stream, Handler&& handler) {
    stream.on_end_();
    websocket::async_teardown(role, stream.socket(), std::forward<Handler>(handler));
  }

 private:
  std::function<void()> on_end_;
};

class WebSocket : public Connection, public std::enable_shared_from_this<WebSocket> {
 public:
  WebSocket(Shared& shared, beast::tcp_stream stream, bool loopback)
      : shared_(shared),
        socket_(std::move(stream), [this] { hang_up_soon(); }),
        wake_(socket_.get_executor()),
        patience_(socket_.get_executor()),
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
    if (std::exchange(closing_, false)) close(websocket::close_code::going_away);
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
    if (std::exchange(closing_, true) || !accepted_) return;  // not in the middle of the handshake: see run()
    socket_.async_close(code, [self = shared_from_this()](BoostError) {});
  }

  void hang_up_soon() {
    patience_.expires_after(shared_.options.limits.closing_time);
    patience_.async_wait([weak = weak_from_this()](BoostError error) {
      const auto self = weak.lock();
      if (!error && self != nullptr) self->hang_up();
    });
  }

  void end() {
    ended_ = true;
    outbox_->close();
    shared_.application.closed(outbox_->id());
  }

  void hang_up() { beast::get_lowest_layer(socket_).close(); }

  Shared& shared_;
  websocket::stream<PageStream> socket_;
  net::steady_timer wake_, patience_;
  const Seat seat_;
  const bool loopback_;
  bool accepted_ = false, ended_ = false, closing_ = false;
  std::shared_ptr<Outbox> outbox_;
};

}  // namespace pointskin::studio::server
