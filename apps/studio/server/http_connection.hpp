// A connection that speaks HTTP/1.1: one request after another, until it becomes a WebSocket or ends.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <pointskin/error.hpp>

#include "studio/server/addresses.hpp"
#include "studio/server/answers.hpp"
#include "studio/server/body.hpp"
#include "studio/server/download_file.hpp"
#include "studio/server/routes.hpp"
#include "studio/server/upload_file.hpp"
#include "studio/server/web_socket.hpp"

namespace pointskin::studio::server {

class HttpConnection : public Connection, public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Shared& shared, tcp::socket socket, Seat seat)
      : shared_(shared), stream_(std::move(socket)), executor_(stream_.get_executor()), seat_(std::move(seat)) {
    BoostError ignored;
    stream_.socket().set_option(tcp::no_delay(true), ignored);
    const tcp::endpoint peer = stream_.socket().remote_endpoint(ignored);
    loopback_ = !ignored && is_loopback(peer.address().to_string());
  }

  void say_goodbye() override {
    net::post(executor_, [self = shared_from_this()] {
      if (self->waiting_) self->close();
    });
  }
  void cut() override {
    net::post(executor_, [self = shared_from_this()] { self->close(); });
  }

  net::awaitable<void> run() {
    try {
      bool first = true;
      while (co_await serve_one(std::exchange(first, false))) {
      }
    } catch (const std::exception&) {
      // The other side is gone or too slow, or the application failed halfway through an answer: nothing can be told.
    }
    close();
  }

 private:
  [[nodiscard]] const Limits& limits() const { return shared_.options.limits; }

  /// @returns whether another request may follow
  net::awaitable<bool> serve_one(bool first) {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(limits().header_bytes));
    parser_->body_limit(boost::none);  // see upload() and session()
    if (!first && buffer_.size() == 0 && !co_await wait_for_request()) co_return false;
    stream_.expires_after(limits().header_time);
    BoostError error;
    const std::size_t bytes = co_await http::async_read_header(stream_, buffer_, *parser_, into(error));
    if (!error && std::cmp_greater(bytes, limits().header_bytes)) error = http::error::header_limit;
    if (error == http::error::end_of_stream) co_return false;
    const bool is_of_http = error.category() == BoostError(http::error::end_of_stream).category();
    if (error && !is_of_http) throw boost::system::system_error(error);
    if (error) co_return co_await refuse_header(error);
    request_ = plain_request();
    route_ = route_of(request_.target);
    co_return co_await answer_request();
  }

  net::awaitable<bool> wait_for_request() {
    stream_.expires_after(limits().idle_time);
    waiting_ = true;
    const std::size_t count = co_await stream_.async_read_some(buffer_.prepare(1024), net::use_awaitable);
    waiting_ = false;
    buffer_.commit(count);
    co_return count > 0;
  }

  net::awaitable<bool> refuse_header(BoostError error) {
    const bool too_large = error == http::error::header_limit || error == http::error::buffer_overflow;
    parser_.emplace();
    co_return co_await refuse(too_large ? Status::header_too_large : Status::bad_request);
  }

  [[nodiscard]] Request plain_request() const {
    const auto& message = parser_->get();
    const auto values = [&message](http::field name) {
      std::vector<std::string> texts;
      const auto [begin, end] = message.equal_range(name);
      for (auto field = begin; field != end; ++field) texts.emplace_back(field->value());
      return texts;
    };
    return {.method = std::string(message.method_string()),
            .target = std::string(message.target()),
            .hosts = values(http::field::host),
            .origins = values(http::field::origin),
            .cookies = values(http::field::cookie),
            .fetch_sites = values(http::field::sec_fetch_site),
            .upgrade = websocket::is_upgrade(message)};
  }

  net::awaitable<bool> answer_request() {
    using Kind = Route::Kind;
    const Status verdict = shared_.guard.verdict(request_, route_);
    if (verdict != Status::ok) co_return co_await refuse(verdict);
    if (route_.kind == Kind::session) co_return co_await session();
    if (route_.kind == Kind::upload) co_return co_await upload();
    if (!parser_->is_done()) co_return co_await refuse(Status::bad_request);  // a body that nobody asked for
    if (route_.kind == Kind::socket) co_return co_await become_socket();
    if (route_.kind == Kind::blob) co_return co_await blob();
    if (route_.kind == Kind::download) co_return co_await download();
    co_return co_await asset();
  }

  // Answers

  [[nodiscard]] Answer answer(Status status, std::string_view type, std::int64_t bytes) const {
    Answer answer{static_cast<http::status>(status), 11};
    for (const auto& [name, value] : fields_of_every_answer()) answer.set(name, value);
    answer.set(http::field::cache_control, "no-store");
    if (!type.empty()) answer.set(http::field::content_type, type);
    if (status != Status::no_content && status != Status::not_modified)
      answer.content_length(static_cast<std::uint64_t>(bytes));
    answer.keep_alive(parser_->is_header_done() && parser_->is_done() && parser_->keep_alive());
    return answer;
  }

  /// @returns whether another request may follow
  net::awaitable<bool> send(Answer& answer, std::span<const std::byte> bytes) {
    co_await send_header(stream_, answer, limits());
    if (request_.method != "HEAD") co_await send_bytes(stream_, bytes, limits());
    if (!answer.keep_alive()) co_await linger(stream_, limits());
    co_return answer.keep_alive();
  }

  net::awaitable<bool> refuse(Status status) {
    const std::string text = std::string(story_of(status)) + "\n";
    Answer refusal = answer(status, "text/plain; charset=utf-8", static_cast<std::int64_t>(text.size()));
    if (status == Status::wrong_method) refusal.set(http::field::allow, route_.methods());
    if (status == Status::upgrade_required) refusal.set(http::field::upgrade, "websocket");
    co_return co_await send(refusal, std::as_bytes(std::span(text)));
  }

  // What is asked for

  net::awaitable<bool> asset() {
    std::optional<Asset> asset;
    if (shared_.options.assets) asset = shared_.options.assets(route_.name);
    if (!asset) co_return co_await refuse(Status::not_found);
    const bool known = parser_->get()[http::field::if_none_match] == asset->etag;
    const std::span<const std::byte> bytes = known ? std::span<const std::byte>() : asset->bytes;
    Answer reply = answer(known ? Status::not_modified : Status::ok, asset->type, std::ssize(bytes));
    reply.set(http::field::cache_control, "no-cache");  // kept, and asked about every time
    reply.set(http::field::etag, asset->etag);
    co_return co_await send(reply, bytes);
  }

  net::awaitable<bool> session() {
    constexpr std::size_t kMost = 1024;
    std::string token;
    BodyReader body(stream_, buffer_, *parser_, limits());
    while (token.size() <= kMost) {
      const std::span<const char> block = co_await body.next();
      if (block.empty()) break;
      token.append(block.data(), block.size());
    }
    if (token.size() > kMost) co_return co_await refuse(Status::too_large);
    if (!shared_.guard.admits(token)) co_return co_await refuse(Status::unauthorised);
    Answer reply = answer(Status::no_content, "", 0);
    reply.set(http::field::set_cookie, shared_.guard.set_cookie());
    co_return co_await send(reply, {});
  }

  net::awaitable<bool> blob() {
    const bool compressed = route_.compressed.value_or(!loopback_);
    const auto find = [this, compressed] { return shared_.application.blob(route_.id, compressed); };
    const std::shared_ptr<const Bytes> bytes = co_await on_worker(shared_, find);
    if (bytes == nullptr) co_return co_await refuse(Status::not_found);
    Answer reply = answer(Status::ok, bytes->type, std::ssize(bytes->data));
    co_return co_await send(reply, bytes->data);
  }

  net::awaitable<bool> download() {
    const auto open_it = [this] {
      const std::optional<Download> found = shared_.application.download(route_.id);
      return found ? DownloadFile::open(*found) : nullptr;
    };
    const std::shared_ptr<DownloadFile> file = co_await on_worker(shared_, open_it);
    if (file == nullptr) co_return co_await refuse(Status::not_found);
    Answer reply = answer(Status::ok, "application/octet-stream", file->size());
    reply.set(http::field::content_disposition, attachment(file->name()));
    co_await send_header(stream_, reply, limits());
    const bool whole = co_await send_file(shared_, stream_, *file);
    if (whole && !reply.keep_alive()) co_await linger(stream_, limits());
    co_return whole&& reply.keep_alive();
  }

  net::awaitable<bool> upload() {
    const auto length = parser_->content_length();
    if (length && *length > static_cast<std::uint64_t>(shared_.options.max_upload))
      co_return co_await refuse(Status::too_large);
    Status failure = Status::ok;
    std::string reply;
    try {
      co_await continue_if_asked();
      failure = co_await receive(reply);
    } catch (const Error&) {
      failure = Status::no_storage;
    }
    if (failure != Status::ok) co_return co_await refuse(failure);
    Answer done = answer(Status::ok, "application/json", std::ssize(reply));
    co_return co_await send(done, std::as_bytes(std::span(reply)));
  }

  /// Clients that ask whether to send at all wait for this.
  net::awaitable<void> continue_if_asked() {
    if (!beast::iequals(parser_->get()[http::field::expect], "100-continue")) co_return;
    static constexpr std::string_view kGoOn = "HTTP/1.1 100 Continue\r\n\r\n";
    co_await net::async_write(stream_, net::buffer(kGoOn), net::use_awaitable);
  }

  /// @param reply  set when the file came whole
  net::awaitable<Status> receive(std::string& reply) {
    UploadFile file(shared_.application.upload_folder(), route_.name);
    BodyReader body(stream_, buffer_, *parser_, limits());
    for (;;) {
      const std::span<const char> block = co_await body.next();
      if (block.empty()) break;
      if (file.size() + std::ssize(block) > shared_.options.max_upload) co_return Status::too_large;
      const auto write_block = [&file, block] { return file.write(block), true; };
      co_await on_worker(shared_, write_block);
    }
    const std::int64_t bytes = file.size();
    const auto hand_over = [&] { return shared_.application.uploaded(file.finish(), route_.name); };
    const std::uint64_t id = co_await on_worker(shared_, hand_over);
    reply = "{\"upload\":" + std::to_string(id) + ",\"bytes\":" + std::to_string(bytes) + "}";
    co_return Status::ok;
  }

  net::awaitable<bool> become_socket() {
    stream_.expires_never();
    upgraded_ = true;
    auto socket = std::make_shared<WebSocket>(shared_, std::move(stream_), loopback_);
    shared_.connections.add(socket);
    co_await socket->run(parser_->get());
    co_return false;
  }

  void close() {
    if (!upgraded_) stream_.close();
  }

  Shared& shared_;
  beast::tcp_stream stream_;
  const net::any_io_executor executor_;
  const Seat seat_;
  bool loopback_ = false;
  bool waiting_ = false;   ///< for the next request
  bool upgraded_ = false;  ///< the stream is another's
  beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  Request request_;
  Route route_;
};

/// Tells somebody that there is no room.
inline net::awaitable<void> refuse_connection(Shared& shared, beast::tcp_stream stream, Seat seat) {
  if (!seat.is_within(shared.options.limits.connections)) co_return;  // too many even to be told
  const std::string text = std::string(story_of(Status::unavailable)) + "\n";
  http::response<http::string_body> answer{http::status::service_unavailable, 11, text};
  for (const auto& [name, value] : fields_of_every_answer()) answer.set(name, value);
  answer.set(http::field::cache_control, "no-store");
  answer.set(http::field::content_type, "text/plain; charset=utf-8");
  answer.keep_alive(false);
  answer.prepare_payload();
  BoostError error;
  stream.expires_after(shared.options.limits.closing_time);
  co_await http::async_write(stream, answer, into(error));
  if (!error) co_await linger(stream, shared.options.limits);
}

}  // namespace pointskin::studio::server
