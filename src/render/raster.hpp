// Which triangle each sample of a band of rows sees.
// Source: Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH 1988 (edge functions).
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "render/camera.hpp"

namespace pointskin::render_detail {

/// A triangle on the picture with its edge functions, exact in integers.
class ScreenTriangle {
 public:
  ScreenTriangle(const ProjectedVertex& a, const ProjectedVertex& b, const ProjectedVertex& c);

  /// Drawn at all: every vertex is on the picture and the corners do not fall into a line.
  [[nodiscard]] bool visible() const { return area_ != 0; }
  /// Its outside, from where its corners run counter-clockwise, faces the viewer.
  [[nodiscard]] bool faces_viewer() const { return front_; }

  /// Samples whose centres may be inside, in samples, both ends included.
  [[nodiscard]] std::int32_t first_row() const;
  [[nodiscard]] std::int32_t last_row() const;
  [[nodiscard]] std::int32_t first_column() const;
  [[nodiscard]] std::int32_t last_column() const;

  /// Weights of the three corners, linear on the picture, at the centre of a sample; they sum to area().
  /// All are >= 0 exactly where the sample is covered.
  struct Weights {
    std::int64_t a, b, c;
    [[nodiscard]] bool inside() const { return (a | b | c) >= 0; }
  };
  [[nodiscard]] Weights at(std::int32_t column, std::int32_t row) const;
  /// Change of the weights from one column to the next.
  [[nodiscard]] Weights column_step() const;
  [[nodiscard]] std::int64_t area() const { return area_; }

  /// Nearness where the weights are `w`.
  [[nodiscard]] float nearness(const Weights& w) const {
    return static_cast<float>((static_cast<double>(w.a) * a_.nearness + static_cast<double>(w.b) * b_.nearness +
                               static_cast<double>(w.c) * c_.nearness) /
                              static_cast<double>(area_));
  }

 private:
  ProjectedVertex a_, b_, c_;
  std::int64_t area_ = 0;  // twice the area, steps^2
  bool front_ = false;
};

/// Rows of samples, with what each of them sees.
struct Band {
  std::int32_t width = 0;                ///< samples
  std::int32_t first_row = 0, rows = 0;  ///< samples
  std::vector<float> nearness;           ///< shape (rows, width); 0 where nothing is seen
  std::vector<std::int32_t> triangles;   ///< shape (rows, width), ids, -1 where nothing is seen

  Band(std::int32_t width, std::int32_t first_row, std::int32_t rows);

  /// Draws triangle `id`; where it ties with one drawn earlier, the earlier one stays.
  void draw(const ScreenTriangle& triangle, std::int32_t id);
};

}  // namespace pointskin::render_detail
