// The shapes of letters: strokes that a round pen follows.
#pragma once

#include <vector>

namespace pointskin::render_detail {

/// Heights above the baseline in the font's unit, of the middle of a pen's line.
inline constexpr double kCapHeight = 14, kSmallHeight = 10, kDescent = -4.5;

struct GlyphPoint {
  double x = 0, y = 0;
};

/// Lines that belong together; one point alone is a dot.
using GlyphLine = std::vector<GlyphPoint>;

struct Glyph {
  double width = 0;  ///< between the middles of its outermost lines
  std::vector<GlyphLine> lines;
};

/// The glyph of an ASCII character, or of kTimes; of any other code a box.
const Glyph& glyph_of(char32_t code);

/// The sign between a number and its power of ten.
inline constexpr char32_t kTimes = 0xD7;

/// The code points of UTF-8 text; bytes that are none count as one each.
std::vector<char32_t> code_points(const char* text);

}  // namespace pointskin::render_detail
