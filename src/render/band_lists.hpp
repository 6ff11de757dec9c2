// Which parts of a drawing a band of the picture's rows may show.
#pragma once

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "exec/cpu_primitives.hpp"
#include "render/drawing.hpp"

namespace pointskin::render_detail {

/// Pixel rows of a band. Bands are drawn one by one, which makes a picture the same for any number of threads.
inline constexpr std::int32_t kBandPixels = 32;

/// For every band the parts whose rows it shares, ascending.
class BandLists {
 public:
  /// O(parts + entries); 4 bytes an entry.
  BandLists(exec::Cpu& ex, const Drawing& drawing, std::int32_t height, int step_bits);

  [[nodiscard]] std::int64_t bands() const { return static_cast<std::int64_t>(begin_.size()) - 1; }
  [[nodiscard]] ArrayView<const std::int32_t> parts(std::int64_t band) const {
    const std::int64_t first = begin_[static_cast<std::size_t>(band)];
    return ids_.cview().part(first, begin_[static_cast<std::size_t>(band) + 1] - first);
  }

 private:
  std::vector<std::int64_t> begin_;  // of every band's list in ids_, and the end
  exec::Buffer<std::int32_t> ids_;
};

}  // namespace pointskin::render_detail
