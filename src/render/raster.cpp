#include "render/raster.hpp"

#include <algorithm>

namespace pointskin::render_detail {
namespace {

/// Twice the signed area of the triangle (a, b, p).
std::int64_t edge(const ProjectedVertex& a, const ProjectedVertex& b, std::int64_t x, std::int64_t y) {
  return (std::int64_t{b.x} - a.x) * (y - a.y) - (std::int64_t{b.y} - a.y) * (x - a.x);
}

std::int64_t centre_of(std::int32_t sample) { return std::int64_t{sample} * kSteps + kSteps / 2; }

// Sample i has its centre at (i + 1/2) kSteps; shifts round towards minus infinity.
std::int32_t first_sample(std::int32_t steps) { return (steps + kSteps / 2 - 1) >> kStepBits; }
std::int32_t last_sample(std::int32_t steps) { return (steps - kSteps / 2) >> kStepBits; }

}  // namespace

ScreenTriangle::ScreenTriangle(const ProjectedVertex& a, const ProjectedVertex& b, const ProjectedVertex& c)
    : a_(a), b_(b), c_(c) {
  if (!a.visible() || !b.visible() || !c.visible()) return;
  area_ = edge(a, b, c.x, c.y);
  // Rows run downwards, so counter-clockwise corners have a negative area. The weights are made positive either way.
  front_ = area_ < 0;
  if (front_) area_ = -area_;
}

std::int32_t ScreenTriangle::first_row() const { return first_sample(std::min({a_.y, b_.y, c_.y})); }
std::int32_t ScreenTriangle::last_row() const { return last_sample(std::max({a_.y, b_.y, c_.y})); }
std::int32_t ScreenTriangle::first_column() const { return first_sample(std::min({a_.x, b_.x, c_.x})); }
std::int32_t ScreenTriangle::last_column() const { return last_sample(std::max({a_.x, b_.x, c_.x})); }

ScreenTriangle::Weights ScreenTriangle::at(std::int32_t column, std::int32_t row) const {
  const std::int64_t x = centre_of(column), y = centre_of(row);
  const std::int64_t sign = front_ ? -1 : 1;
  return {sign * edge(b_, c_, x, y), sign * edge(c_, a_, x, y), sign * edge(a_, b_, x, y)};
}

ScreenTriangle::Weights ScreenTriangle::column_step() const {
  const std::int64_t step = front_ ? kSteps : -kSteps;
  return {step * (std::int64_t{c_.y} - b_.y), step * (std::int64_t{a_.y} - c_.y), step * (std::int64_t{b_.y} - a_.y)};
}

Band::Band(std::int32_t width_, std::int32_t first_row_, std::int32_t rows_)
    : width(width_), first_row(first_row_), rows(rows_) {
  const auto samples = static_cast<std::size_t>(width) * static_cast<std::size_t>(rows);
  nearness.assign(samples, 0);
  triangles.assign(samples, -1);
}

void Band::draw(const ScreenTriangle& triangle, std::int32_t id) {
  const std::int32_t left = std::max(triangle.first_column(), 0);
  const std::int32_t right = std::min(triangle.last_column(), width - 1);
  const std::int32_t top = std::max(triangle.first_row(), first_row);
  const std::int32_t bottom = std::min(triangle.last_row(), first_row + rows - 1);
  const ScreenTriangle::Weights step = triangle.column_step();
  for (std::int32_t row = top; row <= bottom; ++row) {
    ScreenTriangle::Weights w = triangle.at(left, row);
    const std::size_t line = static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(width);
    for (std::int32_t column = left; column <= right; ++column) {
      if (w.inside()) {
        const std::size_t sample = line + static_cast<std::size_t>(column);
        const float near = triangle.nearness(w);
        if (near > nearness[sample]) {
          nearness[sample] = near;
          triangles[sample] = id;
        }
      }
      w = {w.a + step.a, w.b + step.b, w.c + step.c};
    }
  }
}

}  // namespace pointskin::render_detail
