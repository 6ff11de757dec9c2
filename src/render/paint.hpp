// What colour a surface has before it is lit.
#pragma once

#include <pointskin/render.hpp>

#include <optional>
#include <utility>
#include <vector>

#include "render/colour.hpp"
#include "render/colour_map.hpp"
#include "render/vertices.hpp"

namespace pointskin::render_detail {

/// Of faces seen from outside that have no colours of their own, and of faces seen from behind.
Colour clay();
Colour behind();

/// Colours of vertices: values through a map, or red, green and blue, or clay.
class Paint {
 public:
  /// @throws Error usage if there are no values of the name RenderOptions::colour_by
  Paint(const Vertices& vertices, const RenderOptions& options);
  /// Values through a map.
  Paint(const ValueView& values, ColourScale scale) : values_(values), scale_(std::move(scale)) {}

  [[nodiscard]] Colour at(std::size_t vertex) const;
  /// Within a triangle. @param weights  of its corners, their sum is 1
  [[nodiscard]] Colour at(const Triangle& t, const Vec3d& weights) const;

  /// The scale of values, if they give the colours.
  [[nodiscard]] const std::optional<ColourScale>& scale() const { return scale_; }

 private:
  [[nodiscard]] Colour channels(std::size_t vertex) const;
  void use_channels(const Vertices& vertices);

  Colour clay_ = render_detail::clay();
  ValueView values_;
  std::optional<ColourScale> scale_;
  const AttributeValues* channels_[3] = {};  // red, green, blue; null: none
  double to_table_ = 0;                      // from a channel to a place in decoded_
  std::vector<float> decoded_;               // linear light of evenly spaced encoded values in [0, 1]
};

}  // namespace pointskin::render_detail
