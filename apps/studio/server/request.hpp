// A request as far as it matters for who may do what. Plain, so that all of the checks are tested without a socket.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pointskin::studio::server {

struct Request {
  std::string method;                      ///< "GET"
  std::string target;                      ///< as it came: "/blob/7?coding=raw"
  std::vector<std::string> hosts{};        ///< of every such header
  std::vector<std::string> origins{};      ///< of every such header
  std::vector<std::string> cookies{};      ///< of every such header
  std::vector<std::string> fetch_sites{};  ///< of every Sec-Fetch-Site
  bool upgrade = false;                    ///< wants to become a WebSocket
};

/// Statuses that the server gives.
enum class Status : int {
  ok = 200,
  no_content = 204,
  not_modified = 304,
  bad_request = 400,
  unauthorised = 401,
  forbidden = 403,
  not_found = 404,
  wrong_method = 405,
  too_large = 413,
  misdirected = 421,
  upgrade_required = 426,
  header_too_large = 431,
  unavailable = 503,
  no_storage = 507,
};

}  // namespace pointskin::studio::server
