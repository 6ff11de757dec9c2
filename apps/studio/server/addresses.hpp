// Which addresses of this machine a host means, and under which names a server there is known.
#pragma once

#include <string>
#include <vector>

namespace pointskin::studio::server {

/// Numeric addresses, in the order of the hosts, each once: "127.0.0.1", "::1". Where all addresses of the machine are
/// listened on ("0.0.0.0", "::"), those of the same kind are left out.
/// @throws Error usage for a host that is not known
std::vector<std::string> addresses_of(const std::vector<std::string>& hosts);

/// What a header Host may say: the hosts and "localhost", with the port; where all addresses are listened on, also the
/// addresses and the name of this machine. Lower case.
std::vector<std::string> names_of(const std::vector<std::string>& hosts, int port);

/// Whether it is reached from this machine alone: 127.0.0.0/8 or ::1.
bool is_loopback(const std::string& address);

}  // namespace pointskin::studio::server
