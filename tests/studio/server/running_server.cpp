#include "studio/server/running_server.hpp"

#include <unistd.h>

#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace pointskin::test {
namespace {

using studio::server::Asset;

std::filesystem::path new_folder() {
  std::string form = (std::filesystem::temp_directory_path() / "pointskin-server-XXXXXX").string();
  if (mkdtemp(form.data()) == nullptr) throw std::runtime_error("no folder");
  return form;
}

std::optional<Asset> page(std::string_view name) {
  static constexpr std::string_view kPage = "<!doctype html><title>Pointskin</title>";
  static constexpr std::string_view kScript = "export {};";
  const auto asset = [](std::string_view text, const char* type, const char* etag) {
    return Asset{std::as_bytes(std::span(text)), type, etag};
  };
  if (name == "index.html") return asset(kPage, "text/html; charset=utf-8", "\"page\"");
  if (name == "app.js") return asset(kScript, "text/javascript; charset=utf-8", "\"script\"");
  return std::nullopt;
}

studio::server::ServerOptions with_page(studio::server::ServerOptions options) {
  if (!options.assets) options.assets = page;
  return options;
}

}  // namespace

EchoApplication::EchoApplication() : folder(new_folder()) {}
EchoApplication::~EchoApplication() { std::filesystem::remove_all(folder); }

void EchoApplication::opened(std::shared_ptr<studio::Client> client) {
  const std::lock_guard lock(mutex_);
  pages_[client->id()] = std::move(client);
}

void EchoApplication::closed(std::uint64_t client) {
  const std::lock_guard lock(mutex_);
  pages_.erase(client);
}

void EchoApplication::message(const std::shared_ptr<studio::Client>& client, std::string_view json) {
  const std::lock_guard lock(mutex_);
  messages_.emplace_back(json);
  client->send(std::string(json));
}

std::shared_ptr<const studio::Bytes> EchoApplication::blob(std::uint64_t id, bool compressed) {
  const auto found = blobs.find(compressed ? id + 1000 : id);
  return found == blobs.end() ? nullptr : found->second;
}

std::optional<studio::Download> EchoApplication::download(std::uint64_t id) {
  const auto found = downloads.find(id);
  if (found == downloads.end()) return std::nullopt;
  return found->second;
}

std::uint64_t EchoApplication::uploaded(std::filesystem::path file, std::string name) {
  const std::lock_guard lock(mutex_);
  uploads[std::move(name)] = std::move(file);
  return uploads.size();
}

std::size_t EchoApplication::open_pages() {
  const std::lock_guard lock(mutex_);
  return pages_.size();
}

bool EchoApplication::wait_for_pages(std::size_t count) {
  for (int i = 0; i < 1000 && open_pages() != count; ++i) usleep(10'000);
  return open_pages() == count;
}

std::vector<std::string> EchoApplication::messages() {
  const std::lock_guard lock(mutex_);
  return messages_;
}

std::vector<std::shared_ptr<studio::Client>> EchoApplication::pages() {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<studio::Client>> all;
  for (const auto& [id, page] : pages_) all.push_back(page);
  return all;
}

std::vector<std::string> EchoApplication::files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  return names;
}

RunningServer::RunningServer(studio::server::ServerOptions options)
    : server_(with_page(std::move(options)), application), thread_([this] { server_.run(); }) {}

RunningServer::~RunningServer() {
  stop();
  wait();
}

void RunningServer::wait() {
  if (thread_.joinable()) thread_.join();
}

std::string RunningServer::token() const { return url().substr(url().find('#') + 1); }
std::string RunningServer::host() const { return "127.0.0.1:" + std::to_string(port()); }

std::string RunningServer::cookie() {
  if (!cookie_.empty()) return cookie_;
  RawClient client(port());
  const Reply reply = client.ask("POST /session HTTP/1.1\r\nHost: " + host() +
                                 "\r\nConnection: close\r\nContent-Length: 32\r\n\r\n" + token());
  if (reply.status != 204) throw std::runtime_error("no session");
  const std::string set = reply.header("set-cookie");
  return cookie_ = set.substr(0, set.find(';'));
}

std::string RunningServer::request(const std::string& what, const std::string& more, const std::string& body) {
  std::string text = what + " HTTP/1.1\r\nHost: " + host() + "\r\nCookie: " + cookie() + "\r\n" + more;
  if (!body.empty()) text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  return text + "\r\n" + body;
}

std::string RunningServer::upgrade() {
  return "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
}

std::unique_ptr<RawClient> RunningServer::socket() {
  auto client = std::make_unique<RawClient>(port());
  if (client->ask(request("GET /socket", upgrade())).status != 101) throw std::runtime_error("no WebSocket");
  return client;
}

}  // namespace pointskin::test
