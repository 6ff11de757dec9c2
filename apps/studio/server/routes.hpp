// What the path of a request asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "studio/server/request.hpp"

namespace pointskin::studio::server {

struct Route {
  enum class Kind { malformed, unknown, page, asset, session, blob, upload, download, socket };
  Kind kind = Kind::unknown;
  std::string name{};                ///< of an asset or an upload
  std::uint64_t id = 0;              ///< of a blob or a download
  std::optional<bool> compressed{};  ///< unset: as it suits the connection

  /// Anybody may ask for it: it is the same for all, or where the token is given.
  [[nodiscard]] bool is_public() const;
  /// "GET, HEAD" and the like.
  [[nodiscard]] std::string methods() const;
};

/// Never throws. A target that is no path, or whose parts make no sense, is malformed.
Route route_of(std::string_view target);

/// `text` with its %XX and + turned into what they stand for; unset if that is no text: a broken %XX or a NUL.
std::optional<std::string> decoded(std::string_view text);

/// The last part of a file name that came from elsewhere, to be shown and to end a path: no separators, no control
/// characters, no leading dots, at most 200 bytes. Unset if nothing is left.
std::optional<std::string> safe_name(std::string_view name);

}  // namespace pointskin::studio::server
