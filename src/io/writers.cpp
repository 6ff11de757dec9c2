#include "io/writers.hpp"

#include <algorithm>
#include <utility>

namespace pointskin::io {
namespace {

constexpr std::size_t kBlockRows = 1 << 14;

std::int64_t blocks_of(const Section& section) {
  return static_cast<std::int64_t>((section.rows + kBlockRows - 1) / kBlockRows);
}

}  // namespace

Blocks cut_into_blocks(std::string header, std::vector<Section> sections) {
  std::int64_t count = 1;
  for (const Section& section : sections) count += blocks_of(section);
  auto make = [header = std::move(header), sections = std::move(sections)](std::int64_t b, std::string& bytes) {
    if (b == 0) {
      bytes += header;
      return;
    }
    auto section = sections.begin();
    for (--b; b >= blocks_of(*section); ++section) b -= blocks_of(*section);
    const std::size_t first = static_cast<std::size_t>(b) * kBlockRows;
    section->append(first, std::min(section->rows, first + kBlockRows), bytes);
  };
  return {count, std::move(make)};
}

}  // namespace pointskin::io
