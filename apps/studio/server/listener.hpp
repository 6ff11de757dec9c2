// Sockets that listen: one address each, the same port for all.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pointskin/error.hpp>

#include "studio/server/addresses.hpp"
#include "studio/server/net.hpp"

namespace pointskin::studio::server {

/// Opens one. @returns why not, if it could not be
inline BoostError listen_on(tcp::acceptor& acceptor, const std::string& address, int port) {
  BoostError error;
  const tcp::endpoint place(net::ip::make_address(address, error), static_cast<std::uint16_t>(port));
  if (error) return error;
  if (acceptor.open(place.protocol(), error)) return error;
  if (acceptor.set_option(tcp::acceptor::reuse_address(true), error)) return error;
  if (place.address().is_v6() && acceptor.set_option(net::ip::v6_only(true), error)) return error;
  if (acceptor.bind(place, error)) return error;
  acceptor.listen(net::socket_base::max_listen_connections, error);
  return error;
}

/// A machine may be without IPv6.
inline bool may_be_missing(const std::string& address, BoostError error) {
  return address == "::1" &&
         (error == net::error::address_family_not_supported || error == boost::system::errc::address_not_available);
}

[[noreturn]] inline void refuse_to_listen(const std::string& address, int port, BoostError error) {
  if (error == net::error::address_in_use)
    throw Error(ErrorCode::output_not_written, "port " + std::to_string(port) + " of " + address +
                                                   " is taken; choose another with --port, or 0 for any that is free");
  if (error == boost::system::errc::address_not_available)
    throw Error(ErrorCode::usage, "--host: " + address + " is no address of this machine");
  throw Error(ErrorCode::output_not_written,
              "cannot listen on port " + std::to_string(port) + " of " + address + ": " + error.message());
}

/// Opens all. @param port  0: any that is free at all of them @throws Error output_not_written, usage
inline std::vector<tcp::acceptor> listen_on_all(net::io_context& io, const std::vector<std::string>& addresses,
                                                int port) {
  constexpr int kTries = 20;
  for (int attempt = 1;; ++attempt) {
    std::vector<tcp::acceptor> acceptors;
    int chosen = port;
    BoostError error;
    for (const std::string& address : addresses) {
      tcp::acceptor acceptor(io);
      error = listen_on(acceptor, address, chosen);
      if (may_be_missing(address, error)) {
        error = {};
        continue;
      }
      const bool try_another = port == 0 && error == net::error::address_in_use && attempt < kTries;
      if (error && !try_another) refuse_to_listen(address, chosen, error);
      if (error) break;
      chosen = acceptor.local_endpoint().port();
      acceptors.push_back(std::move(acceptor));
    }
    if (!error && !acceptors.empty()) return acceptors;
    if (!error) throw Error(ErrorCode::usage, "--host: there is no address to listen on");
  }
}

}  // namespace pointskin::studio::server
