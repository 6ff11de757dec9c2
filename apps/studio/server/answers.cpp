// RFC 6266 and 8187 (names of attachments). The policy: https://www.w3.org/TR/CSP3/.
#include "studio/server/answers.hpp"

#include <array>

#include "studio/server/routes.hpp"

namespace pointskin::studio::server {
namespace {

// 'wasm-unsafe-eval' lets the page compile WebAssembly, which meshoptimizer's decoder is, and no text as a program.
constexpr char kPolicy[] =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; object-src 'none'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

constexpr std::array<Field, 7> kFields = {{{"Content-Security-Policy", kPolicy},
                                           {"X-Content-Type-Options", "nosniff"},
                                           {"X-Frame-Options", "DENY"},
                                           {"Referrer-Policy", "no-referrer"},
                                           {"Cross-Origin-Opener-Policy", "same-origin"},
                                           {"Cross-Origin-Embedder-Policy", "require-corp"},
                                           {"Cross-Origin-Resource-Policy", "same-origin"}}};

/// Characters that a value may hold as they are (RFC 8187, attr-char, without most signs).
bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
}

}  // namespace

std::span<const Field> fields_of_every_answer() { return kFields; }

std::string_view story_of(Status status) {
  switch (status) {
    case Status::bad_request:
      return "this is no request that the studio understands";
    case Status::unauthorised:
      return "open the address that pointskin studio printed";
    case Status::forbidden:
      return "requests of other pages are refused";
    case Status::not_found:
      return "there is nothing here, or no longer";
    case Status::wrong_method:
      return "this method does nothing here";
    case Status::too_large:
      return "this is larger than the studio takes; see --max-upload";
    case Status::misdirected:
      return "the studio is not known under this name; see --host";
    case Status::upgrade_required:
      return "only a WebSocket can be had here";
    case Status::header_too_large:
      return "the header is larger than 8 KiB";
    case Status::unavailable:
      return "too many connections; close other pages of the studio";
    case Status::no_storage:
      return "the upload could not be written to disk";
    default:
      return "";
  }
}

std::string attachment(std::string_view name) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  const std::string safe = safe_name(name).value_or("download");
  std::string ascii, coded;
  for (const char c : safe) {
    const auto code = static_cast<unsigned char>(c);
    ascii += is_plain(c) || c == ' ' ? c : '_';
    if (is_plain(c))
      coded += c;
    else
      coded += {'%', kDigits[code >> 4], kDigits[code & 15]};
  }
  return "attachment; filename=\"" + ascii + "\"; filename*=UTF-8''" + coded;
}

}  // namespace pointskin::studio::server
