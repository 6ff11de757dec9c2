// The only file that names Boost (with the headers that net.hpp lists): https://www.boost.org/doc/libs/1_81_0/libs/beast.
#include "studio/server/server.hpp"

#include <thread>

#include "studio/server/http_connection.hpp"
#include "studio/server/listener.hpp"
#include "studio/server/net.hpp"
#include "studio/server/secrets.hpp"

namespace pointskin::studio::server {

class Server::Running {
 public:
  Running(ServerOptions options, Application& application)
      : options_(std::move(options)),
        acceptors_(listen_on_all(io_, addresses_of(options_.hosts), options_.port)),
        port_(acceptors_.front().local_endpoint().port()) {
    const std::string token = options_.token.empty() ? random_secret() : options_.token;
    shared_.reset(new Shared{options_, application, Guard(names_of(options_.hosts, port_), port_, token)});
  }

  [[nodiscard]] int port() const { return port_; }

  /// @param secret  that the page exchanges for a cookie
  [[nodiscard]] std::string url(const std::string& secret) const {
    std::string host = options_.hosts.front();
    if (host == "0.0.0.0" || host == "::") host = "127.0.0.1";
    if (host.find(':') != std::string::npos) host = "[" + host + "]";
    return "http://" + host + ":" + std::to_string(port_) + "/#" + secret;
  }

  [[nodiscard]] const Guard& guard() const { return shared_->guard; }

  void run() {
    constexpr int kThreads = 3;
    for (tcp::acceptor& acceptor : acceptors_)
      net::co_spawn(
          io_, [this, &acceptor] { return accept_all(acceptor); }, net::detached);
    std::vector<std::jthread> threads;
    for (int i = 1; i < kThreads; ++i) threads.emplace_back([this] { io_.run(); });
    io_.run();
    threads.clear();
    shared_->workers.join();
  }

  void stop() {
    if (shared_->stopping.exchange(true)) return;
    net::co_spawn(
        io_, [this] { return close_in_order(); }, net::detached);
  }

 private:
  net::awaitable<void> accept_all(tcp::acceptor& acceptor) {
    while (!shared_->stopping) {
      BoostError error;
      auto socket = co_await acceptor.async_accept(net::make_strand(io_), into(error));
      if (shared_->stopping) break;
      if (error)
        co_await wait_for(std::chrono::milliseconds(100));  // out of file descriptors, perhaps: not for ever
      else
        seat(std::move(socket));
    }
  }

  void seat(tcp::socket socket) {
    const net::any_io_executor strand = socket.get_executor();
    Seat seat(shared_->open);
    if (!seat.is_within(options_.limits.connections)) {
      auto refusal = refuse_connection(*shared_, beast::tcp_stream(std::move(socket)), Seat(shared_->refused));
      net::co_spawn(strand, std::move(refusal), net::detached);
      return;
    }
    auto connection = std::make_shared<HttpConnection>(*shared_, std::move(socket), std::move(seat));
    shared_->connections.add(connection);
    net::co_spawn(
        strand, [connection] { return connection->run(); }, net::detached);
  }

  net::awaitable<void> wait_for(std::chrono::milliseconds time) {
    net::steady_timer timer(co_await net::this_coro::executor, time);
    co_await timer.async_wait(net::use_awaitable);
  }

  net::awaitable<void> close_in_order() {
    constexpr std::chrono::milliseconds kStep{5};
    for (tcp::acceptor& acceptor : acceptors_) acceptor.close();
    shared_->connections.each(&Connection::say_goodbye);
    for (auto waited = kStep; shared_->sockets > 0 && waited < options_.limits.closing_time; waited += kStep)
      co_await wait_for(kStep);
    shared_->connections.each(&Connection::cut);
    for (auto waited = kStep; shared_->open > 0 && waited < options_.limits.closing_time; waited += kStep)
      co_await wait_for(kStep);
    io_.stop();  // nothing of ours is left, or it does not listen
  }

  const ServerOptions options_;
  std::unique_ptr<Shared> shared_;  // outlives what still waits in io_
  net::io_context io_;
  net::strand<net::io_context::executor_type> control_{net::make_strand(io_)};  // of the acceptors
  std::vector<tcp::acceptor> acceptors_;
  const int port_;
};

Server::Server(ServerOptions options, Application& application)
    : running_(std::make_unique<Running>(std::move(options), application)) {}
Server::~Server() = default;

int Server::port() const { return running_->port(); }
std::string Server::url() const { return running_->url(running_->guard().token()); }
std::string Server::url_for_browser() const { return running_->url(running_->guard().once()); }
void Server::run() { running_->run(); }
void Server::stop() { running_->stop(); }

}  // namespace pointskin::studio::server
