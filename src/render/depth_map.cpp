#include "render/depth_map.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::render_detail {
namespace {

/// Cells of 2^bits pixels along a side.
std::int32_t cells_along(std::int32_t pixels, int bits) { return (pixels + (1 << bits) - 1) >> bits; }

int bits_for(const MapSize& size) {
  constexpr int kMostBits = 5;  // a band is 2^5 pixels high
  int bits = 0;
  while (bits < kMostBits &&
         std::int64_t{cells_along(size.width, bits)} * cells_along(size.height, bits) > size.most_cells)
    ++bits;
  return bits;
}

/// Averages over four cells along one axis, over one surface.
class Smoothing {
 public:
  Smoothing(const DepthMap& map, std::int32_t dx, std::int32_t dy) : map_(map), dx_(dx), dy_(dy) {}

  [[nodiscard]] float at(const CellFloats& values, std::int32_t column, std::int32_t row) const {
    const std::size_t cell = map_.index(column, row);
    const float near = map_.nearness(cell);
    if (near == 0) return 1;
    float sum = 0, weights = 0;
    for (std::int32_t k = -kHalf; k <= kHalf; ++k) {
      const std::int32_t c = column + k * dx_, r = row + k * dy_;
      if (!map_.holds(c, r)) continue;
      const std::size_t other = map_.index(c, r);
      const float off = (map_.nearness(other) - near) / (6 * map_.slant(near));
      const float fit = std::max(0.0F, 1 - off * off) * (std::abs(k) == kHalf ? 0.5F : 1.0F);
      sum += fit * values[other];
      weights += fit;
    }
    return sum / weights;
  }

 private:
  static constexpr std::int32_t kHalf = 2;  // cells to either side, of which the last count half

  const DepthMap& map_;
  std::int32_t dx_, dy_;
};

}  // namespace

DepthMap::DepthMap(exec::Cpu& ex, const Drawing& drawing, const BandLists& lists, const Camera& camera,
                   const MapSize& size)
    : cell_bits_(bits_for(size)), perspective_(camera.perspective()) {
  width_ = cells_along(size.width, cell_bits_);
  height_ = cells_along(size.height, cell_bits_);
  const double steps = static_cast<double>(std::int64_t{1} << (camera.step_bits() + cell_bits_));
  per_cell_ = static_cast<float>(steps / camera.focal());
  middle_x_ = static_cast<float>(camera.middle_x() / steps - 0.5);
  middle_y_ = static_cast<float>(camera.middle_y() / steps - 0.5);
  nearness_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  const SampleGrid grid = SampleGrid::cells(camera.step_bits(), cell_bits_);
  const std::int32_t rows = kBandPixels >> cell_bits_;
  ex.run_blocks(lists.bands(), [&](std::int64_t b) {
    const std::int32_t first = static_cast<std::int32_t>(b) * rows;
    Band band(grid, width_, first, std::min(rows, height_ - first));
    for (const std::int32_t id : lists.parts(b)) drawing.draw(id, band);
    std::copy(band.nearness.begin(), band.nearness.end(),
              nearness_.begin() + static_cast<std::ptrdiff_t>(index(0, first)));
  });
}

Vec3f DepthMap::to_viewer(const Vec3f& place) const {
  if (!perspective_) return {0, 0, 1};
  return (-1 / std::sqrt(dot(place, place))) * place;
}

CellFloats smoothed(exec::Cpu& ex, const DepthMap& map, const CellFloats& values) {
  const Smoothing across(map, 1, 0), down(map, 0, 1);
  const CellFloats half = for_cells(ex, map, [&](std::int32_t c, std::int32_t r) { return across.at(values, c, r); });
  return for_cells(ex, map, [&](std::int32_t c, std::int32_t r) { return down.at(half, c, r); });
}

}  // namespace pointskin::render_detail
