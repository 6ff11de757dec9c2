// A page's connection to a running studio, without a page: one WebSocket for messages, one connection for blobs.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pointskin::bench {

class Connection {
 public:
  /// @param url  as `pointskin studio` prints it, with the token
  /// @throws std::exception if there is no studio, or it does not know the token
  explicit Connection(const std::string& url);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Sends a request. @returns its id
  int send(const std::string& what, nlohmann::json body = nlohmann::json::object());

  /// The next message, a reply or an event. Waits.
  nlohmann::json receive();

  /// Receives until `wanted` accepts a message; acknowledges meshes and frames on the way.
  nlohmann::json receive(const std::function<bool(const nlohmann::json&)>& wanted);

  /// Sends a request and waits for its reply.
  /// @throws std::runtime_error if the reply is an error
  nlohmann::json ask(const std::string& what, nlohmann::json body = nlohmann::json::object());

  /// What GET answers. @throws std::runtime_error unless that is 200
  std::vector<std::byte> get(const std::string& path);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointskin::bench
