// Where the samples of a picture lie.
#pragma once

#include <array>
#include <cstdint>

namespace pointskin::render_detail {

/// Samples of one per cell, in its middle, or of four, no two of which share a row or a column of eighths: edges near
/// the axes get as many tones as others. A cell is a pixel, or a square of them. Units are steps, see Camera.
class SampleGrid {
 public:
  static constexpr std::int32_t kSamples = 4;  ///< of a pixel, in the picture

  /// Four samples a pixel. @param step_bits  log2 of the steps per pixel, at least 5
  static SampleGrid picture(int step_bits) { return {step_bits, 2}; }
  /// One sample a cell of 2^cell_bits by 2^cell_bits pixels.
  static SampleGrid cells(int step_bits, int cell_bits) { return {step_bits + cell_bits, 0}; }

  [[nodiscard]] std::int32_t rows_per_cell() const { return 1 << row_bits_; }

  // Row r of samples is at (r + 1/2) times the distance of rows; shifts round towards minus infinity.
  [[nodiscard]] std::int32_t first_row(std::int32_t y) const { return (y + half_row() - 1) >> row_step_bits(); }
  [[nodiscard]] std::int32_t last_row(std::int32_t y) const { return (y - half_row()) >> row_step_bits(); }
  [[nodiscard]] std::int64_t y_of(std::int32_t row) const {
    return (std::int64_t{row} << row_step_bits()) + half_row();
  }

  [[nodiscard]] std::int32_t first_column(std::int32_t x, std::int32_t row) const {
    return (x - shift(row) + column_step() - 1) >> column_bits_;
  }
  [[nodiscard]] std::int32_t last_column(std::int32_t x, std::int32_t row) const {
    return (x - shift(row)) >> column_bits_;
  }
  [[nodiscard]] std::int64_t x_of(std::int32_t column, std::int32_t row) const {
    return (std::int64_t{column} << column_bits_) + shift(row);
  }
  [[nodiscard]] std::int32_t column_step() const { return std::int32_t{1} << column_bits_; }

 private:
  SampleGrid(int column_bits, int row_bits) : column_bits_(column_bits), row_bits_(row_bits) {}

  [[nodiscard]] int row_step_bits() const { return column_bits_ - row_bits_; }
  [[nodiscard]] std::int32_t half_row() const { return std::int32_t{1} << (row_step_bits() - 1); }
  /// Of a row's first sample from the left.
  [[nodiscard]] std::int32_t shift(std::int32_t row) const {
    constexpr std::array<std::int32_t, 4> kEighths = {3, 7, 1, 5};
    const std::int32_t eighths = row_bits_ == 0 ? 4 : kEighths[static_cast<std::size_t>(row) & 3U];
    return eighths << (column_bits_ - 3);
  }

  int column_bits_;  // log2 of the steps per cell
  int row_bits_;     // log2 of the rows of samples per cell
};

}  // namespace pointskin::render_detail
