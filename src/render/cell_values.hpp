// Values of a depth map's cells, at the samples of a picture.
#pragma once

#include <cstdint>
#include <vector>

#include "render/depth_map.hpp"

namespace pointskin::render_detail {

/// Where a sample reads from a map: up to four cells, those of the surface that the sample sees.
class CellBlend {
 public:
  /// @param column, row  of the pixel @param nearness  of the sample
  CellBlend(const DepthMap& map, std::int32_t column, std::int32_t row, float nearness);

  /// The cells' mean, weighted by how near they are to the pixel and to the surface; `otherwise` if none is of it.
  template <class T>
  [[nodiscard]] T of(const std::vector<T>& values, const T& otherwise) const {
    if (count_ == 0) return otherwise;
    const T first = values[cells_[0]];  // differences from it: equal values stay as they are, to the last bit
    T sum = first;
    for (int k = 1; k < count_; ++k) sum = sum + weights_[k] * (values[cells_[k]] - first);
    return sum;
  }

 private:
  void add(const DepthMap& map, std::int32_t column, std::int32_t row, float near, float weight);
  void normalise();

  std::size_t cells_[9] = {};
  float weights_[9] = {};
  int count_ = 0;
};

}  // namespace pointskin::render_detail
