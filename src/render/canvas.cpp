#include "render/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/glyphs.hpp"

namespace pointskin::render_detail {
namespace {

double distance(const Place& p, const Place& a, const Place& b) {
  const double x = b.x - a.x, y = b.y - a.y;
  const double squared = x * x + y * y;
  const double t = squared > 0 ? std::clamp(((p.x - a.x) * x + (p.y - a.y) * y) / squared, 0.0, 1.0) : 0;
  return std::hypot(p.x - a.x - t * x, p.y - a.y - t * y);
}

double distance(const Place& p, const std::vector<Place>& line) {
  double nearest = distance(p, line.front(), line.front());
  for (std::size_t i = 1; i < line.size(); ++i) nearest = std::min(nearest, distance(p, line[i - 1], line[i]));
  return nearest;
}

Rectangle bounds_of(const std::vector<std::vector<Place>>& lines, double margin) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Rectangle box{{kInfinity, kInfinity}, {-kInfinity, -kInfinity}};
  for (const std::vector<Place>& line : lines)
    for (const Place& p : line) {
      box.upper_left = {std::min(box.upper_left.x, p.x - margin), std::min(box.upper_left.y, p.y - margin)};
      box.lower_right = {std::max(box.lower_right.x, p.x + margin), std::max(box.lower_right.y, p.y + margin)};
    }
  return box;
}

/// Between letters, and the width of a pen, in the font's unit.
constexpr double kGap = 3.4, kPen = 1.7;

/// Where the lines of letters lie: on the middles of pixels, so that small letters are sharp.
class LetterGrid {
 public:
  LetterGrid(const Place& baseline, double height) : left_(std::floor(baseline.x) + 0.5), unit_(height / kCapHeight) {
    base_ = std::floor(baseline.y) + 0.5;
    small_ = std::round(kSmallHeight * unit_);
    cap_ = std::round(kCapHeight * unit_);
  }
  [[nodiscard]] Place place(double x, const GlyphPoint& p) const {
    return {left_ + (x + p.x) * unit_, base_ - up(p.y)};
  }

 private:
  /// Heights between the baseline, small letters and capitals move with them.
  [[nodiscard]] double up(double y) const {
    if (y <= 0) return y * unit_;
    if (y <= kSmallHeight) return y / kSmallHeight * small_;
    return small_ + (y - kSmallHeight) / (kCapHeight - kSmallHeight) * (cap_ - small_);
  }
  double left_, base_ = 0, unit_, small_ = 0, cap_ = 0;
};

std::vector<std::vector<Place>> lines_of(const Glyph& glyph, double x, const LetterGrid& grid) {
  std::vector<std::vector<Place>> lines;
  for (const GlyphLine& line : glyph.lines) {
    lines.emplace_back();
    for (const GlyphPoint& p : line) lines.back().push_back(grid.place(x, p));
  }
  return lines;
}

}  // namespace

void Canvas::blend(int x, int y, const Ink& ink, double share) {
  std::uint8_t* pixel = image_.rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                                                 static_cast<std::size_t>(x));
  const double alpha = ink.alpha * share;
  for (std::size_t k = 0; k < 3; ++k)
    pixel[k] = static_cast<std::uint8_t>(std::lround((1 - alpha) * pixel[k] + alpha * 255 * ink.rgb[k]));
}

template <class Distance>
void Canvas::cover(const Rectangle& bounds, const Ink& ink, const Distance& distance) {
  const int left = static_cast<int>(std::floor(std::max(bounds.upper_left.x - 1, 0.0)));
  const int top = static_cast<int>(std::floor(std::max(bounds.upper_left.y - 1, 0.0)));
  const int right = static_cast<int>(std::ceil(std::min(bounds.lower_right.x + 1, double(image_.width))));
  const int bottom = static_cast<int>(std::ceil(std::min(bounds.lower_right.y + 1, double(image_.height))));
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const double share = std::clamp(0.5 - distance(Place{x + 0.5, y + 0.5}), 0.0, 1.0);
      if (share > 0) blend(x, y, ink, share);
    }
}

void Canvas::line(const std::vector<Place>& places, double width, const Ink& ink) {
  if (places.empty()) return;
  cover(bounds_of({places}, width / 2), ink, [&](const Place& p) { return distance(p, places) - width / 2; });
}

void Canvas::ring(const Place& middle, double radius, double width, const Ink& ink) {
  const double outer = radius + width / 2;
  cover({{middle.x - outer, middle.y - outer}, {middle.x + outer, middle.y + outer}}, ink,
        [&](const Place& p) { return std::abs(std::hypot(p.x - middle.x, p.y - middle.y) - radius) - width / 2; });
}

void Canvas::fill(const Rectangle& area, double corner, const Ink& ink) {
  const Place middle{(area.upper_left.x + area.lower_right.x) / 2, (area.upper_left.y + area.lower_right.y) / 2};
  const double half_x = (area.lower_right.x - area.upper_left.x) / 2 - corner;
  const double half_y = (area.lower_right.y - area.upper_left.y) / 2 - corner;
  cover(area, ink, [&](const Place& p) {
    const double x = std::abs(p.x - middle.x) - half_x, y = std::abs(p.y - middle.y) - half_y;
    return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0) - corner;
  });
}

void Canvas::triangle(const std::array<Place, 3>& corners, const Ink& ink) {
  const auto side = [&](const Place& p, std::size_t k) {  // distance to the left of a side
    const Place& a = corners[k];
    const Place& b = corners[(k + 1) % 3];
    return ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / std::hypot(b.x - a.x, b.y - a.y);
  };
  const double sign = side(corners[2], 0) > 0 ? -1 : 1;
  cover(bounds_of({{corners.begin(), corners.end()}}, 0), ink, [&](const Place& p) {
    return std::max({sign * side(p, 0), sign * side(p, 1), sign * side(p, 2)});
  });
}

void Canvas::text(const Place& at, const std::string& words, const TextStyle& style, Align align) {
  const double width = text_width(words, style.height);
  const double unit = style.height / kCapHeight;
  const double shift = align == Align::left ? 0 : align == Align::right ? width : width / 2;
  const LetterGrid grid({at.x - shift, at.y}, style.height);
  const double pen = std::max(1.25, kPen * unit), halo = pen + std::max(3.0, 5 * unit);
  const std::vector<char32_t> codes = code_points(words.c_str());
  for (const bool is_halo : {true, false}) {
    const double half = (is_halo ? halo : pen) / 2;
    const Ink& ink = is_halo ? style.halo : style.ink;
    if (ink.alpha == 0) continue;
    double x = 0;
    for (const char32_t code : codes) {
      const Glyph& glyph = glyph_of(code);
      const std::vector<std::vector<Place>> lines = lines_of(glyph, x, grid);
      if (!lines.empty())
        cover(bounds_of(lines, half), ink, [&](const Place& p) {
          double nearest = std::numeric_limits<double>::infinity();
          for (const std::vector<Place>& line : lines) nearest = std::min(nearest, distance(p, line));
          return nearest - half;
        });
      x += glyph.width + kGap;
    }
  }
}

double text_width(const std::string& words, double height) {
  double width = 0;
  for (const char32_t code : code_points(words.c_str())) width += glyph_of(code).width + kGap;
  return std::max(0.0, width - kGap) * height / kCapHeight;
}

}  // namespace pointskin::render_detail
