#include "c/guard.hpp"

namespace pointskin::c {

psk_code fail(psk_error* error, psk_code code, const char* story) noexcept {
  if (error == nullptr) return code;
  std::size_t length = std::min(std::strlen(story), sizeof(error->message) - 1);
  const auto is_continuation = [&](std::size_t i) { return (static_cast<unsigned char>(story[i]) & 0xC0U) == 0x80U; };
  if (story[length] != '\0')
    while (length > 0 && is_continuation(length)) --length;
  error->code = code;
  std::memcpy(error->message, story, length);
  error->message[length] = '\0';
  return code;
}

}  // namespace pointskin::c
