#include "io/source.hpp"

#include <pointskin/error.hpp>

#include "core/format.hpp"

namespace pointskin::io {

std::string printable(std::string_view name) {
  std::string text(name);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown = printable(text.substr(0, kLongest));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';  // a cut or garbled UTF-8 sequence would spoil the message
  return text.size() > kLongest ? fmt::format("'{}...'", shown) : fmt::format("'{}'", shown);
}

void fail(const Source& source, const std::string& what, const std::string& advice) {
  throw Error(ErrorCode::invalid_input, fmt::format("{}: {}; {}", printable(source.name), what, advice));
}

void fail_at_line(const Source& source, const std::string& what, std::int64_t line, const std::string& advice) {
  fail(source, fmt::format("{}, line {}", what, line), advice);
}

void fail_at_byte(const Source& source, const std::string& what, std::size_t byte, const std::string& advice) {
  fail(source, fmt::format("{}, byte {}", what, byte), advice);
}

}  // namespace pointskin::io
