#include "connection.hpp"

#include <cstdint>
#include <limits>
#include <regex>
#include <stdexcept>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace pointskin::bench {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using Json = nlohmann::json;
using boost::asio::ip::tcp;

struct Url {
  std::string host, port, token;
};

Url parse(const std::string& text) {
  std::smatch parts;
  if (!std::regex_match(text, parts, std::regex("http://([^:/]+):([0-9]+)/#(.+)")))
    throw std::runtime_error("'" + text + "' is not http://HOST:PORT/#TOKEN");
  return {parts[1], parts[2], parts[3]};
}

}  // namespace

class Connection::Impl {
 public:
  explicit Impl(const std::string& text)
      : url_(parse(text)), origin_("http://" + authority()), blobs_(context_), socket_(context_) {
    connect(blobs_);
    log_in();
    connect(beast::get_lowest_layer(socket_));
    socket_.set_option(beast::websocket::stream_base::decorator([this](beast::websocket::request_type& request) {
      request.set(http::field::origin, origin_);
      request.set(http::field::cookie, cookie_);
    }));
    socket_.handshake(authority(), "/socket");
  }

  int send(const std::string& what, Json body) {
    body["id"] = ++last_;
    body["do"] = what;
    socket_.write(boost::asio::buffer(body.dump()));
    return last_;
  }

  Json receive() {
    beast::flat_buffer buffer;
    socket_.read(buffer);
    return Json::parse(beast::buffers_to_string(buffer.data()));
  }

  std::vector<std::byte> get(const std::string& path) {
    const auto answer = exchange(http::verb::get, path, {});
    if (answer.result_int() != 200)
      throw std::runtime_error("GET " + path + ": " + std::to_string(answer.result_int()));
    const auto* data = reinterpret_cast<const std::byte*>(answer.body().data());
    return {data, data + answer.body().size()};
  }

 private:
  [[nodiscard]] std::string authority() const { return url_.host + ":" + url_.port; }

  void connect(tcp::socket& socket) {
    boost::asio::connect(socket, tcp::resolver(context_).resolve(url_.host, url_.port));
    socket.set_option(tcp::no_delay(true));
  }

  /// Exchanges the token for a cookie.
  void log_in() {
    const auto answer = exchange(http::verb::post, "/session", url_.token);
    const std::string cookie(answer[http::field::set_cookie]);
    if (answer.result_int() != 204 || cookie.empty()) throw std::runtime_error("the studio does not take this token");
    cookie_ = cookie.substr(0, cookie.find(';'));
  }

  http::response<http::string_body> exchange(http::verb verb, const std::string& path, const std::string& body) {
    http::request<http::string_body> request(verb, path, 11, body);
    request.set(http::field::host, authority());
    request.set(http::field::origin, origin_);
    if (!cookie_.empty()) request.set(http::field::cookie, cookie_);
    request.keep_alive(true);
    request.prepare_payload();
    http::write(blobs_, request);
    http::response_parser<http::string_body> parser;
    parser.body_limit(std::numeric_limits<std::uint64_t>::max());
    http::read(blobs_, buffer_, parser);
    return parser.release();
  }

  Url url_;
  std::string origin_, cookie_;
  boost::asio::io_context context_;
  tcp::socket blobs_;
  beast::websocket::stream<tcp::socket> socket_;
  beast::flat_buffer buffer_;
  int last_ = 0;
};

Connection::Connection(const std::string& url) : impl_(std::make_unique<Impl>(url)) {}
Connection::~Connection() = default;

int Connection::send(const std::string& what, Json body) { return impl_->send(what, std::move(body)); }
Json Connection::receive() { return impl_->receive(); }

Json Connection::receive(const std::function<bool(const Json&)>& wanted) {
  while (true) {
    Json message = receive();
    const std::string event = message.value("event", "");
    if (event == "mesh" || event == "frame") send("ack", {{"version", message["version"]}});
    if (wanted(message)) return message;
  }
}

Json Connection::ask(const std::string& what, Json body) {
  const int id = send(what, std::move(body));
  Json reply = receive([id](const Json& message) { return message.value("id", 0) == id; });
  if (reply.contains("error")) throw std::runtime_error(what + ": " + reply["error"].dump());
  return reply;
}

std::vector<std::byte> Connection::get(const std::string& path) { return impl_->get(path); }

}  // namespace pointskin::bench
