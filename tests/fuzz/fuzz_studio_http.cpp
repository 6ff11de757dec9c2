// Fuzzes what reaches the server of the studio before it knows who sends: HTTP, and frames of a WebSocket. The input is
// what is sent on one connection, where byte 1 stands for a right Host, 2 for the cookie, 3 for the token and 4 for the
// lines that ask for a WebSocket. Without the cookie nothing but the page may come back.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "studio/server/server.hpp"

using namespace pointskin::studio;

namespace {

constexpr std::string_view kSecret = "not for everybody";

class Echo : public Application {
 public:
  void opened(std::shared_ptr<Client> /*client*/) override {}
  void closed(std::uint64_t /*client*/) override {}
  void message(const std::shared_ptr<Client>& client, std::string_view json) override {
    client->send(std::string(kSecret) + std::string(json));
  }
  std::shared_ptr<const Bytes> blob(std::uint64_t id, bool /*compressed*/) override {
    if (id != 1) return nullptr;
    const auto* const bytes = reinterpret_cast<const std::byte*>(kSecret.data());
    return std::make_shared<Bytes>(Bytes{{bytes, bytes + kSecret.size()}});
  }
  std::optional<Download> download(std::uint64_t /*id*/) override { return std::nullopt; }
  std::filesystem::path upload_folder() override { return std::filesystem::temp_directory_path(); }
  std::uint64_t uploaded(std::filesystem::path file, std::string /*name*/) override {
    std::filesystem::remove(file);
    return 1;
  }
};

server::ServerOptions options() {
  server::ServerOptions options;
  options.hosts = {"127.0.0.1"};
  options.max_upload = 1000;
  options.assets = [](std::string_view) { return server::Asset{{}, "text/html", "\"page\""}; };
  return options;
}

/// The fuzzer's timer may interrupt a call.
int connected(int port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in place = {};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(port));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket, reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0) return socket;
  if (errno != EINTR) {
    std::perror("connect");
    std::abort();
  }
  close(socket);
  return connected(port);
}

/// Sends all, and says that nothing follows. @returns all that came back
std::string exchange(int port, const std::string& text) {
  const int socket = connected(port);
  (void)send(socket, text.data(), text.size(), MSG_NOSIGNAL);
  shutdown(socket, SHUT_WR);
  std::string answer;
  std::array<char, 65536> block;
  for (ssize_t count = 0; (count = recv(socket, block.data(), block.size(), 0)) > 0 || (count < 0 && errno == EINTR);)
    answer.append(block.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  const linger at_once{1, 0};  // no thousands of sockets that wait for late packets
  setsockopt(socket, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close(socket);
  return answer;
}

/// The server, which runs as long as the fuzzer.
class Target {
 public:
  Target() : server_(options(), application_) {
    thread_ = std::thread([this] { server_.run(); });
    const std::string url = server_.url();
    token_ = url.substr(url.find('#') + 1);
    host_ = "Host: 127.0.0.1:" + std::to_string(server_.port()) + "\r\n";
    const std::string reply =
        exchange(server_.port(), "POST /session HTTP/1.1\r\n" + host_ + "Content-Length: 32\r\n\r\n" + token_);
    const std::size_t start = reply.find("pointskin_");
    if (start == std::string::npos) std::abort();
    cookie_ = "Cookie: " + reply.substr(start, reply.find(';', start) - start) + "\r\n";
  }
  ~Target() {
    server_.stop();
    thread_.join();
  }

  void try_out(std::string_view input) {
    std::string text;
    for (const char c : input) {
      const std::string* const meant = c == 1   ? &host_
                                       : c == 2 ? &cookie_
                                       : c == 3 ? &token_
                                       : c == 4 ? &upgrade_
                                                : nullptr;
      text += meant != nullptr ? *meant : std::string(1, c);
    }
    const std::string answer = exchange(server_.port(), text);
    if (!answer.empty() && !answer.starts_with("HTTP/1.1 ")) std::abort();
    if (input.find('\2') == std::string_view::npos && answer.find(kSecret) != std::string::npos) std::abort();
  }

 private:
  Echo application_;
  server::Server server_;
  std::thread thread_;
  std::string host_, cookie_, token_;
  const std::string upgrade_ =
      "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Target target;
  target.try_out({reinterpret_cast<const char*>(data), size});
  return 0;
}
