// Bodies of requests and answers, a block at a time: each block has a time limit of its own, so that who is slow is cut
// and who has much is not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "studio/server/download_file.hpp"
#include "studio/server/net.hpp"

namespace pointskin::studio::server {

inline constexpr std::size_t kBlockBytes = 256 * 1024;

using Parser = http::request_parser<http::buffer_body>;
using Answer = http::response<http::empty_body>;

/// Reads the body of a request. @throws boost::system::system_error
class BodyReader {
 public:
  BodyReader(beast::tcp_stream& stream, beast::flat_buffer& buffer, Parser& parser, const Limits& limits)
      : stream_(stream), buffer_(buffer), parser_(parser), limits_(limits), block_(kBlockBytes) {}

  /// The next block; empty at the end. Overwritten by the next call.
  net::awaitable<std::span<const char>> next() {
    if (parser_.is_done()) co_return std::span<const char>();
    auto& body = parser_.get().body();
    body.data = block_.data();
    body.size = block_.size();
    stream_.expires_after(limits_.block_time);
    while (!parser_.is_done() && body.size > 0) {
      BoostError error;
      co_await http::async_read_some(stream_, buffer_, parser_, into(error));
      if (error && error != http::error::need_buffer) throw boost::system::system_error(error);
    }
    co_return std::span<const char>(block_.data(), block_.size() - body.size);
  }

 private:
  beast::tcp_stream& stream_;
  beast::flat_buffer& buffer_;
  Parser& parser_;
  const Limits& limits_;
  std::vector<char> block_;
};

inline net::awaitable<void> send_header(beast::tcp_stream& stream, Answer& answer, const Limits& limits) {
  stream.expires_after(limits.block_time);
  http::response_serializer<http::empty_body> serializer(answer);
  co_await http::async_write_header(stream, serializer, net::use_awaitable);
}

/// Sends memory as it lies there.
inline net::awaitable<void> send_bytes(beast::tcp_stream& stream, std::span<const std::byte> bytes,
                                       const Limits& limits) {
  while (!bytes.empty()) {
    const std::span<const std::byte> block = bytes.first(std::min(bytes.size(), kBlockBytes));
    stream.expires_after(limits.block_time);
    co_await net::async_write(stream, net::buffer(block.data(), block.size()), net::use_awaitable);
    bytes = bytes.subspan(block.size());
  }
}

/// Sends a file. @returns false if it has become shorter than it was
inline net::awaitable<bool> send_file(Shared& shared, beast::tcp_stream& stream, DownloadFile& file) {
  std::vector<std::byte> block(kBlockBytes);
  for (std::int64_t left = file.size(); left > 0;) {
    const std::span<std::byte> space = std::span(block).first(std::min<std::size_t>(block.size(), left));
    const auto read_block = [&file, space] { return file.read(space); };
    const std::size_t count = co_await on_worker(shared, read_block);
    if (count == 0) co_return false;
    co_await send_bytes(stream, space.first(count), shared.options.limits);
    left -= static_cast<std::int64_t>(count);
  }
  co_return true;
}

/// Says that nothing follows, and waits a little for the other side to see it: closing with bytes unread would take our
/// last answer away from it.
inline net::awaitable<void> linger(beast::tcp_stream& stream, const Limits& limits) {
  constexpr std::size_t kMost = 1 << 20;
  BoostError error;
  stream.socket().shutdown(tcp::socket::shutdown_send, error);
  stream.expires_after(limits.closing_time);
  std::vector<char> block(16 * 1024);
  for (std::size_t total = 0; !error && total < kMost;)
    total += co_await stream.async_read_some(net::buffer(block), into(error));
}

}  // namespace pointskin::studio::server
