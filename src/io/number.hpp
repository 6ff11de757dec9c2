// Numbers in text: std::from_chars and nothing else, so no locale can interfere.
#pragma once

#include <charconv>
#include <limits>
#include <string_view>
#include <system_error>

namespace pointskin::io {

constexpr bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r' && c != '\n'); }

/// What may stand between two values of a line.
constexpr bool is_separator(char c) { return is_blank(c) || c == ',' || c == ';'; }

/// The value of a well-formed number that double cannot hold: zero if it is tiny, else infinity.
inline double beyond_double(std::string_view token) {
  const bool negative = token.starts_with('-');
  const std::size_t exponent = token.find_first_of("eE");
  const std::size_t leading = token.find_first_not_of("-0");
  const bool tiny = exponent != std::string_view::npos ? token.substr(exponent + 1).starts_with('-')
                                                       : leading != std::string_view::npos && token[leading] == '.';
  const double size = tiny ? 0.0 : std::numeric_limits<double>::infinity();
  return negative ? -size : size;
}

/// Reads the number that starts at `begin`: "1", "+1.5", "1e-5", "nan", "inf".
/// @returns the end of the number, or nullptr if there is none
inline const char* parse_number(const char* begin, const char* end, double& value) {
  if (begin != end && *begin == '+') {
    ++begin;
    if (begin == end || *begin == '-') return nullptr;
  }
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error == std::errc::invalid_argument) return nullptr;
  if (error == std::errc::result_out_of_range) value = beyond_double({begin, static_cast<std::size_t>(rest - begin)});
  return rest;
}

}  // namespace pointskin::io
