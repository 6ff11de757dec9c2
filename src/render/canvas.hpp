// Drawing on a finished picture: lines, rings and letters, with smooth edges.
#pragma once

#include <pointskin/render.hpp>

#include <array>
#include <string>
#include <vector>

namespace pointskin::render_detail {

/// A place on a picture, in pixels; the middle of the upper left pixel is (0.5, 0.5).
struct Place {
  double x = 0, y = 0;
};

/// What is drawn with: sRGB in [0, 1], and how much of it covers.
struct Ink {
  std::array<double, 3> rgb{0, 0, 0};
  double alpha = 1;
};

/// A rectangle between two corners.
struct Rectangle {
  Place upper_left, lower_right;
};

/// How text looks.
struct TextStyle {
  double height = 14;  ///< of capital letters, pixels; whole ones look best
  Ink ink;
  Ink halo{{1, 1, 1}, 0};  ///< around the letters
};

enum class Align { left, right, middle };

/// Draws onto a picture, which must outlive it. Nothing is drawn beyond its borders.
class Canvas {
 public:
  explicit Canvas(Image& image) : image_(image) {}

  /// A line from place to place, round at its ends and corners. @param width  pixels
  void line(const std::vector<Place>& places, double width, const Ink& ink);
  /// A circle. @param width  of its line, pixels
  void ring(const Place& middle, double radius, double width, const Ink& ink);
  /// A filled rectangle with round corners.
  void fill(const Rectangle& area, double corner, const Ink& ink);
  /// A filled triangle.
  void triangle(const std::array<Place, 3>& corners, const Ink& ink);
  /// Text whose baseline starts (or ends, or has its middle) at `at`, in UTF-8.
  void text(const Place& at, const std::string& words, const TextStyle& style, Align align = Align::left);

 private:
  /// Covers what is inside of a distance function: negative inside, in pixels.
  template <class Distance>
  void cover(const Rectangle& bounds, const Ink& ink, const Distance& distance);
  void blend(int x, int y, const Ink& ink, double share);

  Image& image_;
};

/// Pixels that text of a style takes from left to right.
double text_width(const std::string& words, double height);

}  // namespace pointskin::render_detail
