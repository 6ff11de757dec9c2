#include "render/raster.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::render_detail {
namespace {

/// Twice the signed area of the triangle (a, b, p).
std::int64_t edge(const ProjectedVertex& a, const ProjectedVertex& b, std::int64_t x, std::int64_t y) {
  return (std::int64_t{b.x} - a.x) * (y - a.y) - (std::int64_t{b.y} - a.y) * (x - a.x);
}

}  // namespace

ScreenTriangle::ScreenTriangle(const ProjectedVertex& a, const ProjectedVertex& b, const ProjectedVertex& c)
    : a_(a), b_(b), c_(c) {
  if (!a.visible() || !b.visible() || !c.visible()) return;
  area_ = edge(a, b, c.x, c.y);
  // Rows run downwards, so counter-clockwise corners have a negative area. The weights are made positive either way.
  front_ = area_ < 0;
  if (front_) area_ = -area_;
}

Span ScreenTriangle::rows() const { return {std::min({a_.y, b_.y, c_.y}), std::max({a_.y, b_.y, c_.y})}; }
Span ScreenTriangle::columns() const { return {std::min({a_.x, b_.x, c_.x}), std::max({a_.x, b_.x, c_.x})}; }

ScreenTriangle::Weights ScreenTriangle::at(std::int64_t x, std::int64_t y) const {
  const std::int64_t sign = front_ ? -1 : 1;
  return {sign * edge(b_, c_, x, y), sign * edge(c_, a_, x, y), sign * edge(a_, b_, x, y)};
}

ScreenTriangle::Weights ScreenTriangle::change(std::int64_t steps) const {
  const std::int64_t step = front_ ? steps : -steps;
  return {step * (std::int64_t{c_.y} - b_.y), step * (std::int64_t{a_.y} - c_.y), step * (std::int64_t{b_.y} - a_.y)};
}

double ScreenTriangle::side(int corner) const {
  const ProjectedVertex& from = corner == 0 ? b_ : corner == 1 ? c_ : a_;
  const ProjectedVertex& to = corner == 0 ? c_ : corner == 1 ? a_ : b_;
  return std::hypot(static_cast<double>(to.x) - from.x, static_cast<double>(to.y) - from.y);
}

Band::Band(const SampleGrid& grid_, std::int32_t width_, std::int32_t first_row_, std::int32_t rows_)
    : grid(grid_), width(width_), first_row(first_row_), rows(rows_) {
  const auto samples = static_cast<std::size_t>(width) * static_cast<std::size_t>(rows);
  nearness.assign(samples, 0);
  ids.assign(samples, -1);
}

Span Band::clipped_rows(const Span& steps) const {
  return {std::max(grid.first_row(steps.first), first_row), std::min(grid.last_row(steps.last), first_row + rows - 1)};
}

Span Band::clipped_columns(const Span& steps, std::int32_t row) const {
  return {std::max(grid.first_column(steps.first, row), 0), std::min(grid.last_column(steps.last, row), width - 1)};
}

void Band::draw(const ScreenTriangle& triangle, std::int32_t id) {
  const Span rows_in = clipped_rows(triangle.rows());
  const Span steps = triangle.columns();
  const ScreenTriangle::Weights step = triangle.change(grid.column_step());
  for (std::int32_t row = rows_in.first; row <= rows_in.last; ++row) {
    const Span columns = clipped_columns(steps, row);
    if (columns.first > columns.last) continue;
    ScreenTriangle::Weights w = triangle.at(grid.x_of(columns.first, row), grid.y_of(row));
    std::size_t sample = index(columns.first, row);
    for (std::int32_t column = columns.first; column <= columns.last; ++column, ++sample) {
      if (w.inside()) offer(sample, triangle.nearness(w), id);
      w = {w.a + step.a, w.b + step.b, w.c + step.c};
    }
  }
}

void Band::draw(const ScreenDisc& disc, std::int32_t id) {
  const Span rows_in = clipped_rows({disc.y - disc.reach, disc.y + disc.reach});
  for (std::int32_t row = rows_in.first; row <= rows_in.last; ++row) {
    const Span columns = clipped_columns({disc.x - disc.reach, disc.x + disc.reach}, row);
    const auto dy = static_cast<float>(grid.y_of(row) - disc.y);
    for (std::int32_t column = columns.first; column <= columns.last; ++column) {
      const auto dx = static_cast<float>(grid.x_of(column, row) - disc.x);
      const float squared = disc.radius_squared(dx, dy);
      if (!(squared <= 1)) continue;
      const float near = disc.nearness + disc.slope_x * dx + disc.slope_y * dy;
      offer(index(column, row), disc.bulge > 0 ? near + disc.bulge * std::sqrt(1 - squared) : near, id);
    }
  }
}

}  // namespace pointskin::render_detail
