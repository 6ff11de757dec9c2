// Who may do what. Against pages of other sites, which a browser on this machine may show: they can send requests here,
// and a name of theirs can be made to lead here (DNS rebinding). And against other people of this machine.
#pragma once

#include <atomic>
#include <string>
#include <string_view>
#include <vector>

#include "studio/server/request.hpp"
#include "studio/server/routes.hpp"

namespace pointskin::studio::server {

class Guard {
 public:
  /// @param names  under which the server is known, with the port: "localhost:8123", "[::1]:8123"
  /// @param token  that the page exchanges for the cookie
  Guard(std::vector<std::string> names, int port, std::string token);

  /// Whether the request may be answered: Status::ok, or how to refuse it.
  [[nodiscard]] Status verdict(const Request& request, const Route& route) const;

  /// Whether `secret` is the token, or the one for the browser that is opened, which is good for once: command lines,
  /// and so the addresses that browsers are started with, can be read by other people of this machine.
  [[nodiscard]] bool admits(std::string_view secret);
  /// The value of Set-Cookie for who knows the token.
  [[nodiscard]] std::string set_cookie() const;
  [[nodiscard]] const std::string& token() const { return token_; }
  [[nodiscard]] const std::string& once() const { return once_; }

 private:
  [[nodiscard]] bool is_ours(const std::vector<std::string>& hosts) const;
  [[nodiscard]] bool comes_from_here(const Request& request, const Route& route) const;
  [[nodiscard]] bool has_cookie(const Request& request) const;

  std::vector<std::string> names_;
  std::string token_, once_, cookie_name_, cookie_;
  std::atomic<bool> once_taken_{false};
};

}  // namespace pointskin::studio::server
