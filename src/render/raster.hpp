// Which triangle or disc each sample of a band of rows sees.
// Sources: Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH 1988 (edge functions); Botsch, Hornung,
// Zwicker & Kobbelt, "High-quality surface splatting on today's GPUs", Eurographics PBG 2005 (rays against discs).
#pragma once

#include <cstdint>
#include <vector>

#include "render/camera.hpp"
#include "render/sample_grid.hpp"

namespace pointskin::render_detail {

/// A range of steps or of samples, both ends included; empty if first > last.
struct Span {
  std::int32_t first = 0, last = -1;
};

/// A triangle on the picture with its edge functions, exact in integers.
class ScreenTriangle {
 public:
  ScreenTriangle(const ProjectedVertex& a, const ProjectedVertex& b, const ProjectedVertex& c);

  /// Drawn at all: every vertex is on the picture and the corners do not fall into a line.
  [[nodiscard]] bool visible() const { return area_ != 0; }
  /// Its outside, from where its corners run counter-clockwise, faces the viewer.
  [[nodiscard]] bool faces_viewer() const { return front_; }

  /// Steps that its corners lie between.
  [[nodiscard]] Span rows() const;
  [[nodiscard]] Span columns() const;

  /// Weights of the three corners, linear on the picture, at a place in steps; they sum to area().
  /// All are >= 0 exactly where the place is covered.
  struct Weights {
    std::int64_t a, b, c;
    [[nodiscard]] bool inside() const { return (a | b | c) >= 0; }
  };
  [[nodiscard]] Weights at(std::int64_t x, std::int64_t y) const;
  /// Change of the weights over so many steps to the right.
  [[nodiscard]] Weights change(std::int64_t steps) const;
  /// Twice the area, steps^2.
  [[nodiscard]] std::int64_t area() const { return area_; }
  /// Length of the side opposite corner 0, 1 or 2, steps.
  [[nodiscard]] double side(int corner) const;

  /// Nearness where the weights are `w`.
  [[nodiscard]] float nearness(const Weights& w) const {
    return static_cast<float>((static_cast<double>(w.a) * a_.nearness + static_cast<double>(w.b) * b_.nearness +
                               static_cast<double>(w.c) * c_.nearness) /
                              static_cast<double>(area_));
  }

 private:
  ProjectedVertex a_, b_, c_;
  std::int64_t area_ = 0;
  bool front_ = false;
};

/// A point on the picture: part of a plane, or a ball that faces the viewer.
struct ScreenDisc {
  std::int32_t x = 0, y = 0;       ///< steps
  std::int32_t reach = 0;          ///< steps; nothing of it is farther from its middle along an axis
  float nearness = 0;              ///< in its middle
  float slope_x = 0, slope_y = 0;  ///< of the nearness, per step to the right and downwards
  float xx = 0, xy = 0, yy = 0;    ///< covered where xx dx^2 + 2 xy dx dy + yy dy^2 <= 1, steps^-2
  float bulge = 0;                 ///< by which a ball's middle is nearer than its outline

  [[nodiscard]] float radius_squared(float dx, float dy) const { return xx * dx * dx + (2 * xy * dx + yy * dy) * dy; }
};

/// Rows of samples, with what each of them sees.
struct Band {
  SampleGrid grid;
  std::int32_t width = 0;                ///< samples
  std::int32_t first_row = 0, rows = 0;  ///< samples
  std::vector<float> nearness;           ///< shape (rows, width); 0 where nothing is seen
  std::vector<std::int32_t> ids;         ///< shape (rows, width), -1 where nothing is seen

  Band(const SampleGrid& grid, std::int32_t width, std::int32_t first_row, std::int32_t rows);

  /// Draws what is called `id`; where it ties with what was drawn earlier, that stays.
  void draw(const ScreenTriangle& triangle, std::int32_t id);
  void draw(const ScreenDisc& disc, std::int32_t id);

  [[nodiscard]] std::size_t index(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  }

 private:
  [[nodiscard]] Span clipped_rows(const Span& steps) const;
  [[nodiscard]] Span clipped_columns(const Span& steps, std::int32_t row) const;
  void offer(std::size_t sample, float near, std::int32_t id) {
    if (near <= nearness[sample]) return;
    nearness[sample] = near;
    ids[sample] = id;
  }
};

}  // namespace pointskin::render_detail
