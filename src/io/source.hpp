// What a parser reads: bytes with a name, and the one way in which parsers complain about them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pointskin::io {

/// Bytes to parse and the name they go by in messages. Does not own the bytes.
struct Source {
  std::string name;
  std::string_view bytes;
};

/// `text` in quotes, fit for a one-line message: control characters become '?', long text is cut.
std::string in_quotes(std::string_view text);

/// `name` without control characters, so that a message stays on one line. Never cut: it is a path.
std::string printable(std::string_view name);

/// Throw Error invalid_input as "<name>: <what>[, line N | byte N]; <advice>".
[[noreturn]] void fail(const Source& source, const std::string& what, const std::string& advice);
[[noreturn]] void fail_at_line(const Source& source, const std::string& what, std::int64_t line,
                               const std::string& advice);
[[noreturn]] void fail_at_byte(const Source& source, const std::string& what, std::size_t byte,
                               const std::string& advice);

/// True if `count` records of at least `each` bytes fit into `left` bytes; by division, so it cannot overflow.
constexpr bool fits(std::uint64_t count, std::uint64_t each, std::uint64_t left) {
  return each == 0 || count <= left / each;
}

}  // namespace pointskin::io
