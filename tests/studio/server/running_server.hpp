// A server with an application that answers what it is told, for tests.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "studio/server/raw_client.hpp"
#include "studio/server/server.hpp"

namespace pointskin::test {

/// Sends every message back, and remembers what happened. Has what the tests put into it.
class EchoApplication : public studio::Application {
 public:
  EchoApplication();
  ~EchoApplication() override;

  void opened(std::shared_ptr<studio::Client> client) override;
  void closed(std::uint64_t client) override;
  void message(const std::shared_ptr<studio::Client>& client, std::string_view json) override;
  std::shared_ptr<const studio::Bytes> blob(std::uint64_t id, bool compressed) override;
  std::optional<studio::Download> download(std::uint64_t id) override;
  std::filesystem::path upload_folder() override { return folder; }
  std::uint64_t uploaded(std::filesystem::path file, std::string name) override;

  /// Pages that are connected.
  std::size_t open_pages();
  /// Waits until that many are, for ten seconds.
  bool wait_for_pages(std::size_t count);
  std::vector<std::string> messages();
  std::vector<std::shared_ptr<studio::Client>> pages();
  /// Names of the files in `folder`.
  [[nodiscard]] std::vector<std::string> files() const;

  const std::filesystem::path folder;  ///< an empty one, removed with this
  std::map<std::uint64_t, std::shared_ptr<studio::Bytes>> blobs;
  std::map<std::uint64_t, studio::Download> downloads;
  std::map<std::string, std::filesystem::path> uploads;  ///< by the name that came with them

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::shared_ptr<studio::Client>> pages_;
  std::vector<std::string> messages_;
};

/// Runs while it lives.
class RunningServer {
 public:
  explicit RunningServer(studio::server::ServerOptions options = {});
  ~RunningServer();
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;

  [[nodiscard]] int port() const { return server_.port(); }
  [[nodiscard]] std::string url() const { return server_.url(); }
  [[nodiscard]] std::string url_for_browser() const { return server_.url_for_browser(); }
  [[nodiscard]] std::string token() const;
  /// "127.0.0.1" and the port.
  [[nodiscard]] std::string host() const;
  /// "pointskin_PORT=..." of somebody who gave the token.
  std::string cookie();
  /// A request with a right Host and a cookie. @param more  lines of the header, each with its end
  std::string request(const std::string& what, const std::string& more = "", const std::string& body = "");
  /// A connection that has become a WebSocket.
  std::unique_ptr<RawClient> socket();
  /// The header that asks for one.
  static std::string upgrade();
  void stop() { server_.stop(); }
  void wait();

  EchoApplication application;

 private:
  studio::server::Server server_;
  std::thread thread_;
  std::string cookie_;
};

}  // namespace pointskin::test
