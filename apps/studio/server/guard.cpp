#include "studio/server/guard.hpp"

#include <algorithm>
#include <utility>

#include "studio/server/secrets.hpp"

namespace pointskin::studio::server {
namespace {

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ') || text.starts_with('\t')) text.remove_prefix(1);
  while (text.ends_with(' ') || text.ends_with('\t')) text.remove_suffix(1);
  return text;
}

bool only_reads(const Request& request) { return request.method == "GET" || request.method == "HEAD"; }

}  // namespace

// The cookie is a secret of its own: whoever sees it has not seen the token. Its name holds the port, because cookies of
// one machine are sent to all of its ports, and two studios must not take each other's place.
Guard::Guard(std::vector<std::string> names, int port, std::string token)
    : names_(std::move(names)),
      token_(std::move(token)),
      once_(random_secret()),
      cookie_name_("pointskin_" + std::to_string(port)),
      cookie_(random_secret()) {}

bool Guard::is_ours(const std::vector<std::string>& hosts) const {
  return hosts.size() == 1 && std::find(names_.begin(), names_.end(), lower_case(hosts.front())) != names_.end();
}

// Browsers name the origin with every request that changes something and with every upgrade; what comes without one is
// no page. A header Sec-Fetch-Site, which pages cannot set either, tells of requests that only read.
bool Guard::comes_from_here(const Request& request, const Route& route) const {
  if (!only_reads(request) || request.upgrade || route.kind == Route::Kind::socket) {
    for (const std::string& origin : request.origins) {
      constexpr std::string_view kScheme = "http://";
      if (!origin.starts_with(kScheme) || !is_ours({origin.substr(kScheme.size())})) return false;
    }
  }
  const auto is_foreign = [](const std::string& site) { return site != "same-origin" && site != "none"; };
  const bool is_link = only_reads(request) && route.is_public();
  return is_link || std::none_of(request.fetch_sites.begin(), request.fetch_sites.end(), is_foreign);
}

bool Guard::has_cookie(const Request& request) const {
  bool found = false;
  for (const std::string& header : request.cookies) {
    std::string_view rest = header;
    while (!rest.empty()) {
      const std::string_view pair = trimmed(rest.substr(0, rest.find(';')));
      rest.remove_prefix(
          std::min(rest.size(), rest.find(';') == std::string_view::npos ? rest.size() : rest.find(';') + 1));
      const std::size_t sign = pair.find('=');
      if (sign == std::string_view::npos || pair.substr(0, sign) != cookie_name_) continue;
      found = same_secret(pair.substr(sign + 1), cookie_) || found;
    }
  }
  return found;
}

// The order matters: who must not know anything learns nothing of what there is.
Status Guard::verdict(const Request& request, const Route& route) const {
  if (!is_ours(request.hosts)) return Status::misdirected;
  if (!comes_from_here(request, route)) return Status::forbidden;
  if (!route.is_public() && !has_cookie(request)) return Status::unauthorised;
  if (route.kind == Route::Kind::malformed) return Status::bad_request;
  if (route.kind == Route::Kind::unknown) return Status::not_found;
  const std::string methods = ", " + route.methods() + ",";
  if (methods.find(", " + request.method + ",") == std::string::npos) return Status::wrong_method;
  if (route.kind == Route::Kind::socket && !request.upgrade) return Status::upgrade_required;
  return Status::ok;
}

bool Guard::admits(std::string_view secret) {
  return same_secret(secret, token_) || (same_secret(secret, once_) && !once_taken_.exchange(true));
}

std::string Guard::set_cookie() const { return cookie_name_ + "=" + cookie_ + "; HttpOnly; SameSite=Strict; Path=/"; }

}  // namespace pointskin::studio::server
