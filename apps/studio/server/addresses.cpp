#include "studio/server/addresses.hpp"

#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>

#include <pointskin/error.hpp>

namespace pointskin::studio::server {
namespace {

void add(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

bool has(const std::vector<std::string>& list, const std::string& text) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

bool is_v6(const std::string& address) { return address.find(':') != std::string::npos; }
bool is_any(const std::string& address) { return address == "0.0.0.0" || address == "::"; }

std::string numeric(const sockaddr* address, socklen_t size) {
  std::array<char, NI_MAXHOST> text{};
  if (getnameinfo(address, size, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) != 0) return "";
  return text.data();
}

void add_resolved(std::vector<std::string>& addresses, const std::string& host) {
  addrinfo wanted = {};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &wanted, &found); error != 0)
    throw Error(ErrorCode::usage, "--host: '" + host + "' is no address of this machine: " + gai_strerror(error));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> list(found, freeaddrinfo);
  for (const addrinfo* entry = found; entry != nullptr; entry = entry->ai_next)
    add(addresses, numeric(entry->ai_addr, entry->ai_addrlen));
}

/// All addresses and the name of this machine.
std::vector<std::string> own_names() {
  std::vector<std::string> names;
  ifaddrs* found = nullptr;
  if (getifaddrs(&found) == 0) {
    const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> list(found, freeifaddrs);
    for (const ifaddrs* entry = found; entry != nullptr; entry = entry->ifa_next) {
      if (entry->ifa_addr == nullptr) continue;
      if (entry->ifa_addr->sa_family == AF_INET) add(names, numeric(entry->ifa_addr, sizeof(sockaddr_in)));
      if (entry->ifa_addr->sa_family == AF_INET6) add(names, numeric(entry->ifa_addr, sizeof(sockaddr_in6)));
    }
  }
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) == 0 && name[0] != '\0') add(names, name.data());
  return names;
}

}  // namespace

std::vector<std::string> addresses_of(const std::vector<std::string>& hosts) {
  std::vector<std::string> addresses;
  for (const std::string& host : hosts) add_resolved(addresses, host);
  const bool any_v4 = has(addresses, "0.0.0.0"), any_v6 = has(addresses, "::");
  std::erase_if(addresses, [&](const std::string& address) {
    return address.empty() || (!is_any(address) && (is_v6(address) ? any_v6 : any_v4));
  });
  return addresses;
}

std::vector<std::string> names_of(const std::vector<std::string>& hosts, int port) {
  std::vector<std::string> all = hosts;
  add(all, "localhost");
  if (std::any_of(hosts.begin(), hosts.end(), is_any))
    for (const std::string& name : own_names()) add(all, name);
  std::vector<std::string> names;
  for (const std::string& host : all) {
    std::string name = is_v6(host) ? "[" + host + "]" : host;
    for (char& c : name)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (port == 80) add(names, name);  // browsers leave the usual port out
    add(names, name + ":" + std::to_string(port));
  }
  return names;
}

bool is_loopback(const std::string& address) { return address.starts_with("127.") || address == "::1"; }

}  // namespace pointskin::studio::server
