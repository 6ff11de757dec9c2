#include "render/band_lists.hpp"

#include <algorithm>

namespace pointskin::render_detail {

BandLists::BandLists(exec::Cpu& ex, const Drawing& drawing, std::int32_t height, int step_bits) {
  constexpr int kBandBits = 5;
  static_assert(1 << kBandBits == kBandPixels);
  const std::int64_t parts = drawing.size();
  const std::int64_t block = std::clamp<std::int64_t>(parts / 64, 1 << 12, 1 << 18);
  const std::int64_t blocks = exec::block_count(parts, block);
  const auto bands = static_cast<std::size_t>(exec::block_count(height, kBandPixels));

  // A count, then a place, for every block and band: blocks write into their own parts of every list.
  std::vector<std::int64_t> place(static_cast<std::size_t>(blocks) * bands, 0);
  const auto visit = [&](std::int64_t b, const auto& at_band) {
    for (std::int64_t id = b * block; id < std::min(parts, (b + 1) * block); ++id) {
      const Span rows = drawing.rows(id);
      if (rows.first > rows.last) continue;
      const std::int32_t first = std::max(rows.first >> (step_bits + kBandBits), 0);
      const std::int32_t last = std::min(rows.last >> (step_bits + kBandBits), static_cast<std::int32_t>(bands) - 1);
      for (std::int32_t band = first; band <= last; ++band)
        at_band(id, place[static_cast<std::size_t>(b) * bands + static_cast<std::size_t>(band)]);
    }
  };
  ex.run_blocks(blocks, [&](std::int64_t b) { visit(b, [](std::int64_t, std::int64_t& count) { ++count; }); });
  begin_.assign(bands + 1, 0);
  std::int64_t sum = 0;
  for (std::size_t band = 0; band < bands; ++band) {
    begin_[band] = sum;
    for (std::size_t b = 0; b < static_cast<std::size_t>(blocks); ++b) {
      std::int64_t& entry = place[b * bands + band];
      const std::int64_t count = entry;
      entry = sum;
      sum += count;
    }
  }
  begin_[bands] = sum;
  ids_ = exec::Buffer<std::int32_t>(ex.pool(), sum);
  ex.run_blocks(blocks, [&](std::int64_t b) {
    visit(b, [&](std::int64_t id, std::int64_t& at) { ids_.data()[at++] = static_cast<std::int32_t>(id); });
  });
}

}  // namespace pointskin::render_detail
