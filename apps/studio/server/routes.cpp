#include "studio/server/routes.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace pointskin::studio::server {
namespace {

constexpr std::string_view kAssets = "/assets/", kBlob = "/blob/", kDownload = "/download/";

std::optional<std::uint64_t> number_of(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The value of `key` in "a=1&b=2", decoded; unset if it is not there or broken.
std::optional<std::string> parameter(std::string_view query, std::string_view key) {
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
    const std::size_t sign = pair.find('=');
    if (sign != std::string_view::npos && pair.substr(0, sign) == key) return decoded(pair.substr(sign + 1));
  }
  return std::nullopt;
}

Route numbered(Route::Kind kind, std::string_view id) {
  const std::optional<std::uint64_t> value = number_of(id);
  if (!value) return {Route::Kind::unknown};
  return {.kind = kind, .id = *value};
}

Route blob_route(std::string_view id, std::string_view query) {
  Route route = numbered(Route::Kind::blob, id);
  if (query.empty()) return route;
  const std::optional<std::string> coding = parameter(query, "coding");
  if (coding != "raw" && coding != "compressed") return {Route::Kind::malformed};
  route.compressed = coding == "compressed";
  return route;
}

Route upload_route(std::string_view query) {
  const std::optional<std::string> name = parameter(query, "name");
  const std::optional<std::string> safe = name ? safe_name(*name) : std::nullopt;
  if (!safe) return {Route::Kind::malformed};
  return {Route::Kind::upload, *safe};
}

}  // namespace

bool Route::is_public() const { return kind == Kind::page || kind == Kind::asset || kind == Kind::session; }

std::string Route::methods() const {
  if (kind == Kind::session || kind == Kind::upload) return "POST";
  if (kind == Kind::socket || kind == Kind::download) return "GET";
  return "GET, HEAD";
}

Route route_of(std::string_view target) {
  if (!target.starts_with('/')) return {Route::Kind::malformed};
  const std::size_t mark = target.find('?');
  const std::string_view path = target.substr(0, mark);
  const std::string_view query = mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
  if (path == "/") return {Route::Kind::page, "index.html"};
  if (path == "/session") return {Route::Kind::session};
  if (path == "/socket") return {Route::Kind::socket};
  if (path == "/upload") return upload_route(query);
  if (path.starts_with(kAssets)) return {Route::Kind::asset, std::string(path.substr(kAssets.size()))};
  if (path.starts_with(kBlob)) return blob_route(path.substr(kBlob.size()), query);
  if (path.starts_with(kDownload)) return numbered(Route::Kind::download, path.substr(kDownload.size()));
  return {Route::Kind::unknown};
}

std::optional<std::string> decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    unsigned code = 0;
    const auto [end, error] = std::from_chars(text.data() + i + 1, text.data() + i + 3, code, 16);
    if (error != std::errc() || end != text.data() + i + 3 || code == 0) return std::nullopt;
    result += static_cast<char>(code);
    i += 2;
  }
  return result;
}

std::optional<std::string> safe_name(std::string_view name) {
  constexpr std::size_t kMost = 200;
  name = name.substr(name.find_last_of("/\\") + 1);  // npos + 1 is 0
  std::string safe;
  for (const char c : name) {
    const auto code = static_cast<unsigned char>(c);
    if (safe.empty() && c == '.') continue;
    safe += code < 0x20 || code == 0x7f ? '_' : c;
  }
  if (safe.empty()) return std::nullopt;
  return safe.size() > kMost ? safe.substr(safe.size() - kMost) : safe;  // the end tells the format
}

}  // namespace pointskin::studio::server
