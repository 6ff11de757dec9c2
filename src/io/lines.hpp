// Text cut at line borders into blocks that are parsed in parallel, and the reader of one line's values.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "io/blocks.hpp"
#include "io/number.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// A line that holds values: not blank, no "#" or "//" comment.
struct Line {
  std::string_view text;    ///< without the line's end; a '\r' may be left and counts as blank
  std::int64_t number = 0;  ///< in the file, from 1
  std::int64_t row = 0;     ///< among the lines that hold values, from 0
};

/// True if the line holds values (see Line).
bool is_row(std::string_view line);

/// Consecutive lines of a text.
struct LineBlock {
  std::string_view text;
  std::int64_t first_line = 0;
  std::int64_t first_row = 0;
};

/// Blocks of a text with the line and row numbers at which they start. Borders depend on the text alone.
struct LineIndex {
  std::vector<LineBlock> blocks;
  std::int64_t rows = 0;      ///< up to its end
  std::int64_t end_line = 1;  ///< the line behind its last

  [[nodiscard]] std::int64_t block_count() const noexcept { return static_cast<std::int64_t>(blocks.size()); }
  [[nodiscard]] std::int64_t rows_before(std::int64_t block) const noexcept {
    return block < block_count() ? blocks[static_cast<std::size_t>(block)].first_row : rows;
  }
};

/// Counts lines and rows of `text` in parallel. O(n), even for a text without a line end.
/// @param first_line  number of the first line of `text` in its file
/// @param first_row   rows of the file before it
LineIndex index_lines(exec::Cpu& ex, std::string_view text, std::int64_t first_line = 1, std::int64_t first_row = 0);

/// The blocks that hold rows [first, last).
LineIndex blocks_of_rows(const LineIndex& index, std::int64_t first, std::int64_t last);

/// Calls f(text of the line) for every line of `text`, in order, until it returns false.
template <class F>
void for_each_line(std::string_view text, const F& f) {
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    const auto* border = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
    const char* line_end = border != nullptr ? border : end;
    if (!f(std::string_view(at, static_cast<std::size_t>(line_end - at)))) return;
    at = border != nullptr ? border + 1 : end;
  }
}

/// Calls f(line, block) for every row in [first, last), blocks in parallel, the rows of a block in order.
/// @throws the first error of the text, whatever the number of threads
template <class F>
void for_each_row(exec::Cpu& ex, const LineIndex& index, std::int64_t first, std::int64_t last, const F& f) {
  run_in_order(ex, index.block_count(), [&](std::int64_t b) {
    if (index.rows_before(b + 1) <= first || index.rows_before(b) >= last) return;
    const LineBlock& block = index.blocks[static_cast<std::size_t>(b)];
    Line line{{}, block.first_line - 1, block.first_row - 1};
    for_each_line(block.text, [&](std::string_view text) {
      ++line.number;
      if (!is_row(text)) return true;
      ++line.row;
      line.text = text;
      if (line.row >= first && line.row < last) f(static_cast<const Line&>(line), static_cast<std::size_t>(b));
      return line.row + 1 < last;
    });
  });
}

/// Reads the values of one line from left to right. Separators may be repeated; "#" ends the line.
class Values {
 public:
  Values(const Source& source, const Line& line)
      : source_(source), line_(line), at_(line.text.data()), end_(at_ + line.text.size()) {}

  /// True if no value is left.
  bool at_end() {
    while (at_ != end_ && is_separator(*at_)) ++at_;
    return at_ == end_ || *at_ == '#';
  }

  /// The next value. @throws Error invalid_input if there is none or it is not a number
  double number() {
    double value = 0;
    if (at_end()) fail_missing();
    const char* rest = parse_number(at_, end_, value);
    if (rest == nullptr || (rest != end_ && !is_separator(*rest))) fail_garbled("is not a number");
    at_ = rest;
    return value;
  }

  /// The next value, which must be a whole number that double holds exactly.
  std::int64_t whole() {
    constexpr double kExact = 9007199254740992.0;  // 2^53
    const char* begin = at_;
    const double value = number();
    if (!(std::abs(value) <= kExact) || value != std::floor(value)) {
      at_ = begin;
      at_end();
      fail_garbled("is not a whole number");
    }
    return static_cast<std::int64_t>(value);
  }

  /// The next run of characters up to a separator; empty at the end.
  std::string_view word() {
    if (at_end()) return {};
    const char* begin = at_;
    at_ = std::find_if(at_, end_, is_separator);
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }

  /// @throws Error invalid_input if values are left
  void expect_end() {
    if (!at_end()) fail_garbled("is one value too many");
  }

  /// Throws Error invalid_input about the value at which the reader stands.
  [[noreturn]] void fail_garbled(const char* what);

 private:
  [[noreturn]] void fail_missing();

  const Source& source_;
  const Line& line_;
  const char* at_;
  const char* end_;
};

/// `text` without a UTF-8 byte order mark.
std::string_view without_byte_order_mark(std::string_view text);

}  // namespace pointskin::io
