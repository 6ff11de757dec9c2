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

LineIndex index_lines(exec::Cpu& ex, std::string_view text, std::int64_t first_line) {
  LineIndex index{cut_at_lines(text), 0};
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
  return index;
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
