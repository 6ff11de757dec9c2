#include "render/colour_bar.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/format.hpp"
#include "render/canvas.hpp"
#include "render/glyphs.hpp"
#include "render/picture_scale.hpp"
#include "render/ticks.hpp"

namespace pointskin::render_detail {
namespace {

constexpr std::array<double, 3> kDark = {0.13, 0.15, 0.18};

/// Height of capital letters, whole pixels: 15 at scale 1, and never illegible.
double letter_height(const RenderOptions& options) { return std::max(8.0, std::round(15 * picture_scale(options))); }

std::array<double, 3> encoded(const Colour& colour) {
  return {encode_srgb(colour[0]), encode_srgb(colour[1]), encode_srgb(colour[2])};
}

class ColourBar {
 public:
  ColourBar(const ColourScale& scale, const RenderOptions& options, Image& image)
      : scale_(scale), options_(options), canvas_(image), letter_(letter_height(options)) {
    right_ = options.width - letter_;
    const double left = options.width - colour_bar_width(options) + letter_;
    bar_ = {{std::round(left), std::round(options.height * 0.24)},
            {std::round(left + 1.5 * letter_), std::round(options.height * 0.86)}};
  }

  void draw() {
    colours();
    ends();
    numbers();
    name();
    if (scale_.has_none()) none();
  }

 private:
  [[nodiscard]] TextStyle style(double height) const { return {height, {kDark, 1}, {{1, 1, 1}, 0.75}}; }
  [[nodiscard]] double height() const { return bar_.lower_right.y - bar_.upper_left.y; }
  [[nodiscard]] double y_of(double value) const {
    const ValueRange& range = scale_.range();
    return bar_.lower_right.y - (value - range.low) / (range.high - range.low) * height();
  }

  void colours() {
    const int rows = static_cast<int>(height());
    for (int row = 0; row < rows; ++row) {
      const double top = bar_.upper_left.y + row;
      const double t = 1 - (row + 0.5) / rows;
      canvas_.fill({{bar_.upper_left.x, top}, {bar_.lower_right.x, top + 1}}, 0, {encoded(scale_.at(t)), 1});
    }
  }

  /// A pointed end says that there are values beyond it. The outline goes around all.
  void ends() {
    const double middle = (bar_.upper_left.x + bar_.lower_right.x) / 2;
    const double point = 0.9 * letter_;
    const double left = bar_.upper_left.x, right = bar_.lower_right.x;
    const double top = bar_.upper_left.y, bottom = bar_.lower_right.y;
    std::vector<Place> outline = {{left, top}};
    if (scale_.goes_above()) {
      canvas_.triangle({{{left, top}, {right, top}, {middle, top - point}}}, {encoded(scale_.at(1)), 1});
      outline.push_back({middle, top - point});
    }
    outline.insert(outline.end(), {{right, top}, {right, bottom}});
    if (scale_.goes_below()) {
      canvas_.triangle({{{left, bottom}, {right, bottom}, {middle, bottom + point}}}, {encoded(scale_.at(0)), 1});
      outline.push_back({middle, bottom + point});
    }
    outline.insert(outline.end(), {{left, bottom}, {left, top}});
    canvas_.line(outline, line_width(), {kDark, 0.8});
  }

  [[nodiscard]] double line_width() const { return std::max(1.0, letter_ / 14); }

  void numbers() {
    const int most = std::clamp(static_cast<int>(height() / (3.2 * letter_)), 2, 8);
    const Ticks ticks = ticks_of(scale_.range(), most);
    const double from = bar_.lower_right.x + 0.75 * letter_;
    double widest = 1;
    for (const Tick& tick : ticks.ticks) widest = std::max(widest, text_width(tick.label, letter_));
    const double size = letter_ * std::min(1.0, (right_ - from) / widest);
    for (const Tick& tick : ticks.ticks) {
      const double y = std::clamp(std::floor(y_of(tick.value)) + 0.5, bar_.upper_left.y, bar_.lower_right.y);
      canvas_.line({{bar_.lower_right.x, y}, {bar_.lower_right.x + 0.35 * letter_, y}}, line_width(), {kDark, 0.8});
      canvas_.text({from, y + size / 2}, tick.label, style(size));
    }
    has_power_ = ticks.exponent != 0;
    if (has_power_) power(ticks.exponent);
  }

  /// Beside the upper end: what the numbers are multiplied by.
  void power(int exponent) {
    const double y = bar_.upper_left.y - 1.5 * letter_;
    const std::string ten =
        "\xC3\x97"
        "10";
    const double x = bar_.lower_right.x + 0.75 * letter_;
    canvas_.text({x, y + 0.4 * letter_}, ten, style(letter_));
    canvas_.text({x + text_width(ten, letter_) + 0.3 * letter_, y - 0.3 * letter_}, std::to_string(exponent),
                 style(std::round(0.7 * letter_)));
  }

  void name() {
    const double room = 0.6 * options_.width;
    const double width = text_width(options_.colour_by, letter_);
    const double size = std::max(6.0, letter_ * std::min(1.0, room / std::max(width, 1.0)));
    const double y = bar_.upper_left.y - (has_power_ ? 3.4 : 1.9) * letter_;
    // It starts over the bar if there is room for it.
    const bool fits = bar_.upper_left.x + width <= right_;
    canvas_.text({fits ? bar_.upper_left.x : right_, y}, options_.colour_by, style(size),
                 fits ? Align::left : Align::right);
  }

  void none() {
    const double top = bar_.lower_right.y + 2.4 * letter_;
    const Rectangle box{{bar_.upper_left.x, top}, {bar_.lower_right.x, top + letter_}};
    canvas_.fill(box, 0, {encoded(no_value_colour()), 1});
    canvas_.text({bar_.lower_right.x + 0.75 * letter_, top + letter_}, "none", style(letter_));
  }

  const ColourScale& scale_;
  const RenderOptions& options_;
  Canvas canvas_;
  double letter_;
  double right_ = 0;  // where text ends
  bool has_power_ = false;
  Rectangle bar_;
};

}  // namespace

int colour_bar_width(const RenderOptions& options) {
  constexpr int kLeastWidth = 160, kLeastHeight = 120;
  const bool shown = !options.colour_by.empty() && options.colour_bar && options.width >= kLeastWidth &&
                     options.height >= kLeastHeight;
  return shown ? static_cast<int>(9 * letter_height(options)) : 0;
}

void draw_colour_bar(const ColourScale& scale, const RenderOptions& options, Image& image) {
  if (colour_bar_width(options) > 0) ColourBar(scale, options, image).draw();
}

}  // namespace pointskin::render_detail
