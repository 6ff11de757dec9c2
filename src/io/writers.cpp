#include "io/writers.hpp"

#include <algorithm>
#include <memory>
#include <utility>

namespace pointskin::io {
namespace {

constexpr std::size_t kBlockRows = 1 << 14;

std::int64_t blocks_of(const Section& section) {
  return static_cast<std::int64_t>((section.rows + kBlockRows - 1) / kBlockRows);
}

}  // namespace

Blocks cut_into_blocks(std::string header, std::vector<Section> sections) {
  const std::size_t header_bytes = header.size();
  const auto append_header = [header = std::move(header)](std::size_t, std::size_t, std::string& bytes) {
    bytes += header;
  };
  sections.insert(sections.begin(), {1, append_header, header_bytes});
  Blocks blocks;
  for (const Section& section : sections) blocks.count += blocks_of(section);
  const auto all = std::make_shared<const std::vector<Section>>(std::move(sections));
  blocks.make = [all](std::int64_t b, std::string& bytes) {
    auto section = all->begin();
    for (; b >= blocks_of(*section); ++section) b -= blocks_of(*section);
    const std::size_t first = static_cast<std::size_t>(b) * kBlockRows;
    section->append(first, std::min(section->rows, first + kBlockRows), bytes);
  };
  if (!std::ranges::all_of(*all, [](const Section& section) { return section.row_bytes > 0; })) return blocks;
  blocks.place = [all](std::int64_t b) {
    std::size_t bytes = 0;
    for (auto section = all->begin(); section != all->end() && b > 0; b -= blocks_of(*section++))
      bytes += std::min(section->rows, static_cast<std::size_t>(b) * kBlockRows) * section->row_bytes;
    return static_cast<std::int64_t>(bytes);
  };
  return blocks;
}

}  // namespace pointskin::io
