#include "io/lines.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 18;

/// Borders are searched from left to right, each byte once: a text without line ends costs O(n), not O(n * blocks).
std::vector<LineBlock> cut_at_lines(std::string_view text) {
  std::vector<LineBlock> blocks;
  while (!text.empty()) {
    std::size_t end = text.size();
    if (end > kBlockBytes) {
      const std::size_t border = text.find('\n', kBlockBytes - 1);
      if (border != std::string_view::npos) end = border + 1;
    }
    blocks.push_back({text.substr(0, end), 0, 0});
    text.remove_prefix(end);
  }
  return blocks;
}

}  // namespace

bool is_row(std::string_view line) {
  const auto* first = std::find_if_not(line.begin(), line.end(), is_separator);
  if (first == line.end() || *first == '#') return false;
  return !(*first == '/' && first + 1 != line.end() && first[1] == '/');
}

LineIndex index_lines(exec::Cpu& ex, std::string_view text, std::int64_t first_line, std::int64_t first_row) {
  LineIndex index{cut_at_lines(text), first_row};
  run_in_order(ex, index.block_count(), [&](std::int64_t b) {
    LineBlock& block = index.blocks[static_cast<std::size_t>(b)];
    for_each_line(block.text, [&](std::string_view line) {
      ++block.first_line;
      if (is_row(line)) ++block.first_row;
      return true;
    });
  });
  // The counts become starts.
  for (LineBlock& block : index.blocks) {
    const std::int64_t lines = block.first_line;
    const std::int64_t rows = block.first_row;
    block.first_line = first_line;
    block.first_row = index.rows;
    first_line += lines;
    index.rows += rows;
  }
  index.end_line = first_line;
  return index;
}

LineIndex blocks_of_rows(const LineIndex& index, std::int64_t first, std::int64_t last) {
  const auto begins_behind = [](std::int64_t row, const LineBlock& block) { return row < block.first_row; };
  const auto begin = index.blocks.begin();
  const auto behind = std::upper_bound(begin, index.blocks.end(), first, begins_behind);
  const auto from = behind == begin ? begin : behind - 1;  // of blocks without rows the last
  const auto to =
      std::max(from, std::lower_bound(begin, index.blocks.end(), last,
                                      [](const LineBlock& block, std::int64_t row) { return block.first_row < row; }));
  const auto in = [&](auto at) { return at == index.blocks.end(); };
  return {{from, to}, in(to) ? index.rows : to->first_row, in(to) ? index.end_line : to->first_line};
}

void Values::fail_garbled(const char* what) {
  const char* token_end = std::find_if(at_, end_, is_separator);
  fail_at_line(source_, in_quotes({at_, static_cast<std::size_t>(token_end - at_)}) + " " + what, line_.number,
               "correct the line or export the file again");
}

void Values::fail_missing() {
  fail_at_line(source_, "a value is missing at the end of the line", line_.number,
               "correct the line or export the file again");
}

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

}  // namespace pointskin::io
