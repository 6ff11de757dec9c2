// Looking at pictures.
#pragma once

#include <pointskin/render.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>

namespace pointskin::test {

using Rgb = std::array<int, 3>;

inline Rgb pixel(const Image& image, int x, int y) {
  const std::size_t at =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

inline Rgb middle(const Image& image) { return pixel(image, image.width / 2, image.height / 2); }

/// Largest difference of a channel.
inline int difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Pixels of which a channel differs by more than `tolerance`.
inline int differing(const Image& a, const Image& b, int tolerance = 0) {
  int count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) count += difference(pixel(a, x, y), pixel(b, x, y)) > tolerance ? 1 : 0;
  return count;
}

/// The pixels, both ends included, that something is on.
struct PixelBox {
  int left = 1 << 20, top = 1 << 20, right = -1, bottom = -1, count = 0;

  [[nodiscard]] int width() const { return right - left + 1; }
  [[nodiscard]] int height() const { return bottom - top + 1; }
};

/// Where `image` is not the background, which `empty` shows.
inline PixelBox covered(const Image& image, const Image& empty) {
  PixelBox box;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (difference(pixel(image, x, y), pixel(empty, x, y)) <= 2) continue;
      box = {std::min(box.left, x), std::min(box.top, y), std::max(box.right, x), std::max(box.bottom, y),
             box.count + 1};
    }
  return box;
}

/// The background of a picture of these options.
inline Image background_of(RenderOptions options) {
  options.colour_by.clear();
  return render(Mesh{}, options);
}

/// Straight from the front, without perspective.
inline RenderOptions front_view(int width = 200, int height = 150) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.azimuth_degrees = 0;
  options.elevation_degrees = 0;
  options.projection = Projection::orthographic;
  return options;
}

/// How red, or how blue, something is: of the tone of backs, of diverging maps.
inline int redness(const Rgb& p) { return p[0] - std::max(p[1], p[2]); }
inline int lightness(const Rgb& p) { return (2 * p[0] + 5 * p[1] + p[2]) / 8; }

}  // namespace pointskin::test
