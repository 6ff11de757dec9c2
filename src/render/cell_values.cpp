#include "render/cell_values.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::render_detail {

CellBlend::CellBlend(const DepthMap& map, std::int32_t column, std::int32_t row, float nearness) {
  // The middle of the pixel between the middles of the cells around it; at a cell a pixel it is one of them.
  const auto cell = static_cast<float>(1 << map.cell_bits());
  const float x = (static_cast<float>(column) + 0.5F) / cell - 0.5F;
  const float y = (static_cast<float>(row) + 0.5F) / cell - 0.5F;
  const auto left = static_cast<std::int32_t>(std::floor(x)), top = static_cast<std::int32_t>(std::floor(y));
  const float right_part = x - static_cast<float>(left), bottom_part = y - static_cast<float>(top);
  for (std::int32_t k = 0; k < 4; ++k) {
    const std::int32_t dx = k & 1, dy = k >> 1;
    const float weight = (dx == 1 ? right_part : 1 - right_part) * (dy == 1 ? bottom_part : 1 - bottom_part);
    if (weight > 0) add(map, left + dx, top + dy, nearness, weight);
  }
  if (count_ == 0)  // an outline, or a corner of another surface: whatever belongs to it near by
    for (std::int32_t k = 0; k < 9; ++k) add(map, left + k % 3 - 1, top + k / 3 - 1, nearness, 1);
  normalise();
}

void CellBlend::add(const DepthMap& map, std::int32_t column, std::int32_t row, float near, float weight) {
  if (!map.holds(column, row)) return;
  const std::size_t cell = map.index(column, row);
  if (map.nearness(cell) == 0) return;
  const float off = (map.nearness(cell) - near) / (8 * map.slant(near));
  const float fit = weight * std::max(0.0F, 1 - off * off);
  if (!(fit > 0)) return;
  cells_[count_] = cell;
  weights_[count_] = fit;
  ++count_;
}

void CellBlend::normalise() {
  float sum = 0;
  for (int k = 0; k < count_; ++k) sum += weights_[k];
  for (int k = 0; k < count_; ++k) weights_[k] /= sum;
}

}  // namespace pointskin::render_detail
