// What a server of the studio serves: messages, blobs, uploads and downloads. Knows no transport.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pointskin::studio {

/// One page that is connected.
class Client {
 public:
  Client() = default;
  virtual ~Client() = default;
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Sends a message, from any thread and without waiting; does nothing once the page is gone.
  virtual void send(std::string json) = 0;
  /// The page runs on this machine, so that compression costs more than it saves.
  [[nodiscard]] virtual bool loopback() const = 0;
  [[nodiscard]] virtual std::uint64_t id() const = 0;
};

/// What `/blob/ID` answers.
struct Bytes {
  std::vector<std::byte> data;
  std::string type = "application/octet-stream";
};

/// What `/download/ID` answers, as an attachment.
struct Download {
  std::filesystem::path file;
  std::string name;        ///< that the browser saves it under
  bool temporary = false;  ///< the file is removed afterwards
};

/// All functions may be called from any thread of the server.
class Application {
 public:
  Application() = default;
  virtual ~Application() = default;
  Application(const Application&) = delete;
  Application& operator=(const Application&) = delete;

  virtual void opened(std::shared_ptr<Client> client) = 0;
  virtual void closed(std::uint64_t client) = 0;
  /// A text message of a page, as it came. Never waits for work, never throws: errors are replies.
  virtual void message(const std::shared_ptr<Client>& client, std::string_view json) = 0;
  /// @returns null for an id that there is not, or no longer
  virtual std::shared_ptr<const Bytes> blob(std::uint64_t id, bool compressed) = 0;
  virtual std::optional<Download> download(std::uint64_t id) = 0;
  /// Where the server writes uploads while they come.
  [[nodiscard]] virtual std::filesystem::path upload_folder() = 0;
  /// Takes over a file that came whole. @returns its id for `open` and others
  virtual std::uint64_t uploaded(std::filesystem::path file, std::string name) = 0;
};

}  // namespace pointskin::studio
