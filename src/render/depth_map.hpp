// How near what is seen is, over the whole picture, and what follows from it: normals, and light that does not get into
// creases and hollows.
#pragma once

#include <cstdint>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "render/band_lists.hpp"
#include "render/camera.hpp"
#include "render/drawing.hpp"

namespace pointskin::render_detail {

/// How large a map is to be.
struct MapSize {
  std::int32_t width = 1, height = 1;  ///< of the picture, pixels
  std::int64_t most_cells = 1;
};

/// A cell is a pixel, or of large pictures a square of them: what is made of it varies slowly.
class DepthMap {
 public:
  /// Draws `drawing` with a sample in the middle of every cell.
  /// @param size  of the picture, in pixels, that `camera` is for
  DepthMap(exec::Cpu& ex, const Drawing& drawing, const BandLists& lists, const Camera& camera, const MapSize& size);

  [[nodiscard]] std::int32_t width() const { return width_; }
  [[nodiscard]] std::int32_t height() const { return height_; }
  /// log2 of the pixels along a cell's side.
  [[nodiscard]] int cell_bits() const { return cell_bits_; }
  [[nodiscard]] bool holds(std::int32_t column, std::int32_t row) const {
    return column >= 0 && row >= 0 && column < width_ && row < height_;
  }
  [[nodiscard]] std::size_t index(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
  }

  /// As ProjectedVertex::nearness; 0 where nothing is seen.
  [[nodiscard]] float nearness(std::size_t cell) const { return nearness_[cell]; }
  /// What a cell sees, in the viewer's frame: radii from the viewer (perspective), or from the plane through the
  /// middle.
  [[nodiscard]] Vec3f place(std::int32_t column, std::int32_t row) const {
    return place(column, row, nearness_[index(column, row)]);
  }
  [[nodiscard]] Vec3f place(std::int32_t column, std::int32_t row, float nearness) const {
    const float x = (static_cast<float>(column) - middle_x_) * per_cell_;
    const float y = (middle_y_ - static_cast<float>(row)) * per_cell_;
    if (!perspective_) return {x, y, nearness - 2};
    const float depth = 1 / nearness;
    return {x * depth, y * depth, -depth};
  }
  /// Unit vector from a place towards the viewer.
  [[nodiscard]] Vec3f to_viewer(const Vec3f& place) const;
  /// By how much the nearness changes from a cell to the next where what is seen slants by 45 degrees.
  [[nodiscard]] float slant(float nearness) const { return perspective_ ? nearness * per_cell_ : per_cell_; }
  /// Cells that a length of one radius spans at a nearness.
  [[nodiscard]] float cells_per_radius(float nearness) const {
    return perspective_ ? nearness / per_cell_ : 1 / per_cell_;
  }

 private:
  std::int32_t width_, height_;
  int cell_bits_;
  bool perspective_;
  float per_cell_;               // radii at unit depth
  float middle_x_, middle_y_;    // cells, of the middle of the picture; column 0 has its sample at 0
  std::vector<float> nearness_;  // shape (height, width)
};

/// Normals that the depth has, shape as the map, in the viewer's frame; zero where nothing is seen.
/// @param reach  cells to either side whose plane is taken: 1 for surfaces, more for surfaces made of points
std::vector<Vec3f> normals_of(exec::Cpu& ex, const DepthMap& map, int reach);

/// Shape as the map.
using CellFloats = std::vector<float>;

/// Share of the light of all sides that reaches each cell; 1 where nothing is in its way.
CellFloats openness_of(exec::Cpu& ex, const DepthMap& map, const std::vector<Vec3f>& normals, float radius_cells);

/// value(column, row) of every cell, in parallel.
template <class F>
CellFloats for_cells(exec::Cpu& ex, const DepthMap& map, const F& value) {
  CellFloats values(static_cast<std::size_t>(map.width()) * static_cast<std::size_t>(map.height()));
  ex.run_blocks(map.height(), [&](std::int64_t r) {
    const auto row = static_cast<std::int32_t>(r);
    for (std::int32_t column = 0; column < map.width(); ++column) values[map.index(column, row)] = value(column, row);
  });
  return values;
}

/// Means over the surface around every cell, four cells wide: values may differ within squares of so many cells if they
/// do so alike in all squares.
CellFloats smoothed(exec::Cpu& ex, const DepthMap& map, const CellFloats& values);

}  // namespace pointskin::render_detail
