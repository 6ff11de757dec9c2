// A plain font without serifs, drawn for this program. A line is written as a letter and points: l straight from point
// to point, b a curve that leaves the first point towards the second, touches the lines between the points in their
// middles, and ends in the last (a quadratic B-spline), o the same, closed.
#include "render/glyphs.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

namespace pointskin::render_detail {
namespace {

struct Drawn {
  double width;
  const char* lines;
};

/// From the space, code 32, to the tilde, code 126.
constexpr std::array<Drawn, 95> kDrawn = {{
    {3, ""},
    {0, "l 0,14 0,4.6 l 0,0.2 0,0.4"},                                                                           // !
    {3, "l 0,14 0,10.5 l 3,14 3,10.5"},                                                                          // "
    {8, "l 2.4,14 1.2,0 l 6.8,14 5.6,0 l 0.2,9.4 8,9.4 l 0,4.6 7.8,4.6"},                                        // #
    {7.6, "b 7,11 6,12.6 0.4,12.9 0.4,7.4 7.6,6.8 7.6,0.8 1.2,1 0,3.4 l 3.9,14.6 3.9,-1"},                       // $
    {9.4, "l 0.6,0 8.8,14 o 0,14 3.8,14 3.8,8.4 0,8.4 o 5.6,5.6 9.4,5.6 9.4,0 5.6,0"},                           // %
    {9.4, "b 9.4,0 3,7.5 1.2,9.4 1.2,14.2 6.6,14.2 6.6,9 0,7 0,-0.2 7.6,-0.8 8.8,6.4"},                          // &
    {0, "l 0,14 0,10.5"},                                                                                        // '
    {3.2, "b 3.2,15.5 0,11.5 0,1 3.2,-3"},                                                                       // (
    {3.2, "b 0,15.5 3.2,11.5 3.2,1 0,-3"},                                                                       // )
    {6, "l 3,14 3,7.6 l 0.2,12.4 5.8,9.2 l 0.2,9.2 5.8,12.4"},                                                   // *
    {7, "l 0,6.5 7,6.5 l 3.5,3 3.5,10"},                                                                         // +
    {1, "l 1,0.4 0.2,-2.2"},                                                                                     // ,
    {5.4, "l 0.2,6.2 5.2,6.2"},                                                                                  // -
    {0.6, "l 0.2,0.2 0.4,0.2"},                                                                                  // .
    {5.4, "l 0,-1.5 5.4,15"},                                                                                    // /
    {8, "o 0,14 8,14 8,0 0,0"},                                                                                  // 0
    {8, "l 1.6,11.2 5,14 5,0"},                                                                                  // 1
    {8, "b 0.4,10.6 0.4,14.2 7.8,14.2 7.8,9 4,4.6 0.2,0 l 0.2,0 8,0"},                                           // 2
    {8, "b 0.4,11.4 0.9,14 7.6,14 7.6,7.6 3,7.6 b 3,7.6 8.2,7.6 8.2,0 0.6,0 0.1,3"},                             // 3
    {8, "l 6,0 6,14 0,4.4 8,4.4"},                                                                               // 4
    {8, "l 7.4,14 1.2,14 0.7,7.6 b 0.7,7.6 2,9 8,9.2 8,-0.1 0.7,-0.1 0.1,2.8"},                                  // 5
    {8, "b 7,12 6.2,14 0,14.4 0,4.5 o 0,9 8,9 8,0 0,0"},                                                         // 6
    {8, "l 0,14 8,14 2.8,0"},                                                                                    // 7
    {8, "o 0.6,14 7.4,14 7.4,7.6 0.6,7.6 o 0,7.6 8,7.6 8,0 0,0"},                                                // 8
    {8, "b 1,2 1.8,0 8,-0.4 8,9.5 o 0,14 8,14 8,5 0,5"},                                                         // 9
    {0.6, "l 0.2,0.2 0.4,0.2 l 0.2,8.2 0.4,8.2"},                                                                // :
    {1, "l 1,0.4 0.2,-2.2 l 0.8,8.2 1,8.2"},                                                                     // ;
    {7, "l 7,10.4 0,6.5 7,2.6"},                                                                                 // <
    {7, "l 0,8.4 7,8.4 l 0,4.6 7,4.6"},                                                                          // =
    {7, "l 0,10.4 7,6.5 0,2.6"},                                                                                 // >
    {6.8, "b 0,11.4 0.6,14.2 6.8,14.2 6.8,8.6 3.2,8.2 3.2,4.6 l 3.2,0.2 3.2,0.4"},                               // ?
    {12, "o 3.4,9.6 8.4,9.6 8.4,3 3.4,3 b 8.6,9.8 8,2 11.8,2 12,6.4 12,14 0,14 0,-2.4 7,-2.2 9.4,-1.4"},         // @
    {9.6, "l 0,0 4.8,14 9.6,0 l 1.7,4.8 7.9,4.8"},                                                               // A
    {8.8, "l 4.6,7.5 0,7.5 l 4.8,0 0,0 0,14 4.5,14 b 4.5,14 8.1,14 8.1,7.5 4.5,7.5 b 4.6,7.5 9,7.5 9,0 4.7,0"},  // B
    {9, "b 9,11.3 7.8,14 0,14.2 0,-0.2 7.8,0 9,2.7"},                                                            // C
    {9.4, "l 3.5,0 0,0 0,14 3.5,14 b 3.5,14 9.6,14 9.6,0 3.5,0"},                                                // D
    {7.8, "l 7.6,14 0,14 0,0 7.8,0 l 0,7.4 6.6,7.4"},                                                            // E
    {7.6, "l 7.6,14 0,14 0,0 l 0,7.2 6.6,7.2"},                                                                  // F
    {9.4, "b 9,11.3 7.8,14 0,14.2 0,-0.2 7.4,-0.2 9.4,3 l 9.4,3 9.4,6.8 5.4,6.8"},                               // G
    {8.8, "l 0,0 0,14 l 8.8,0 8.8,14 l 0,7.3 8.8,7.3"},                                                          // H
    {0, "l 0,0 0,14"},                                                                                           // I
    {5.4, "l 5.4,14 5.4,4 b 5.4,4 5.4,-0.4 0.4,-0.4 0,3"},                                                       // J
    {8.6, "l 0,0 0,14 l 8,14 0,5.6 l 3,8.7 8.6,0"},                                                              // K
    {7.2, "l 0,14 0,0 7.2,0"},                                                                                   // L
    {10.8, "l 0,0 0,14 5.4,3.4 10.8,14 10.8,0"},                                                                 // M
    {8.8, "l 0,0 0,14 8.8,0 8.8,14"},                                                                            // N
    {10.4, "o 0,14 10.4,14 10.4,0 0,0"},                                                                         // O
    {8.6, "l 0,0 0,14 4.6,14 b 4.6,14 8.8,14 8.8,6.6 4.6,6.6 l 4.6,6.6 0,6.6"},                                  // P
    {10.4, "o 0,14 10.4,14 10.4,0 0,0 l 6.4,3.4 10.2,-0.8"},                                                     // Q
    {8.8, "l 0,0 0,14 4.6,14 b 4.6,14 8.6,14 8.6,6.8 4.6,6.8 l 4.6,6.8 0,6.8 l 4.4,6.8 8.8,0"},                  // R
    {8.4, "b 7.9,11.4 7,14.1 0.4,14.4 0.4,7.8 8.4,6.8 8.4,-0.5 1.2,-0.1 0,2.9"},                                 // S
    {9.4, "l 0,14 9.4,14 l 4.7,14 4.7,0"},                                                                       // T
    {8.8, "l 0,14 0,5 b 0,5 0,-0.1 8.8,-0.1 8.8,5 l 8.8,5 8.8,14"},                                              // U
    {9.4, "l 0,14 4.7,0 9.4,14"},                                                                                // V
    {13.2, "l 0,14 3.2,0 6.6,12 10,0 13.2,14"},                                                                  // W
    {8.8, "l 0,14 8.8,0 l 0,0 8.8,14"},                                                                          // X
    {9.2, "l 0,14 4.6,6.6 4.6,0 l 9.2,14 4.6,6.6"},                                                              // Y
    {8.6, "l 0.2,14 8.4,14 0,0 8.6,0"},                                                                          // Z
    {2.8, "l 2.8,15 0,15 0,-2.5 2.8,-2.5"},                                                                      // [
    {5.4, "l 0,15 5.4,-1.5"},                                                    // backslash
    {2.8, "l 0,15 2.8,15 2.8,-2.5 0,-2.5"},                                      // ]
    {6, "l 0,9.6 3,14 6,9.6"},                                                   // ^
    {6.4, "l 0,-2 6.4,-2"},                                                      // _
    {2.4, "l 0,14 2.4,11.4"},                                                    // `
    {7, "o 0,10 7,10 7,0 0,0 l 7,10 7,0"},                                       // a
    {7.2, "l 0,14.5 0,0 o 0,10 7.2,10 7.2,0 0,0"},                               // b
    {6.8, "b 6.8,8.1 5.8,10 0,10.2 0,-0.2 5.8,0 6.8,1.9"},                       // c
    {7, "l 7,14.5 7,0 o 0,10 7,10 7,0 0,0"},                                     // d
    {7.2, "l 0.1,5.2 7.2,5.2 b 7.2,5.2 7.2,10 0,10 0,-0.2 5.8,-0.1 7,2.2"},      // e
    {4.6, "b 4.6,13.9 2,14.5 2,10.5 l 2,10.5 2,0 l 0,10 4.4,10"},                // f
    {7, "o 0,10 7,10 7,0 0,0 l 7,10 7,-0.4 b 7,-0.4 7,-4.6 1.2,-4.6 0.5,-2.6"},  // g
    {6.6, "l 0,14.5 0,0 b 0,6 0.4,10.1 6.6,10.1 6.6,6 l 6.6,6 6.6,0"},           // h
    {0, "l 0,10 0,0 l 0,13.8 0,14"},                                             // i
    {2.2, "l 2.2,10 2.2,-1.8 b 2.2,-1.8 2.2,-4.5 0,-4.3 l 2.2,13.8 2.2,14"},     // j
    {6.6, "l 0,14.5 0,0 l 6.2,10 0,4 l 2.4,6.3 6.6,0"},                          // k
    {1.8, "l 0,14.5 0,2.2 b 0,2.2 0,-0.1 1.8,0"},                                // l
    {10.4,
     "l 0,10 0,0 b 0,6.4 0.3,10.1 5.2,10.1 5.2,6.4 l 5.2,6.4 5.2,0 b 5.2,6.4 5.5,10.1 10.4,10.1 10.4,6.4 l 10.4,6.4 "
     "10.4,0"},                                                                  // m
    {6.6, "l 0,10 0,0 b 0,6 0.4,10.1 6.6,10.1 6.6,6 l 6.6,6 6.6,0"},             // n
    {7.4, "o 0,10 7.4,10 7.4,0 0,0"},                                            // o
    {7.2, "l 0,10 0,-4.5 o 0,10 7.2,10 7.2,0 0,0"},                              // p
    {7, "l 7,10 7,-4.5 o 0,10 7,10 7,0 0,0"},                                    // q
    {4.4, "l 0,10 0,0 b 0,5.6 0.2,10 2.6,10.2 4.4,9.8"},                         // r
    {6.2, "b 5.9,8.2 5.2,10.1 0.3,10.3 0.3,5.6 6.2,4.8 6.2,-0.3 0.9,-0.1 0,2"},  // s
    {4.6, "l 2,13.4 2,2.6 b 2,2.6 2,-0.3 4.6,0.2 l 0,10 4.4,10"},                // t
    {6.6, "l 0,10 0,4 b 0,4 0,-0.1 6.2,-0.1 6.6,4 l 6.6,10 6.6,0"},              // u
    {6.8, "l 0,10 3.4,0 6.8,10"},                                                // v
    {10, "l 0,10 2.6,0 5,8.6 7.4,0 10,10"},                                      // w
    {6.4, "l 0,10 6.4,0 l 0,0 6.4,10"},                                          // x
    {7, "l 0,10 3.5,0 l 7,10 3.5,0 b 3.5,0 2.2,-3.8 1.6,-4.6 0,-4.3"},           // y
    {6.4, "l 0.2,10 6.2,10 0,0 6.4,0"},                                          // z
    {4, "b 4,15.3 1.6,15.3 1.6,7.6 0,6.3 b 0,6.3 1.6,5 1.6,-2.8 4,-2.8"},        // {
    {0, "l 0,15.5 0,-3"},                                                        // |
    {4, "b 0,15.3 2.4,15.3 2.4,7.6 4,6.3 b 4,6.3 2.4,5 2.4,-2.8 0,-2.8"},        // }
    {7, "b 0,5.6 1,8.6 3.4,7 5.8,4.4 7,7.4"},                                    // ~
}};
constexpr Drawn kDrawnTimes = {6, "l 0.4,9.4 5.6,3.8 l 0.4,3.8 5.6,9.4"};
constexpr Drawn kDrawnBox = {6, "l 0,0 0,12 6,12 6,0 0,0"};

GlyphPoint between(const GlyphPoint& a, const GlyphPoint& b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/// Goes on to `c` in a curve that `b` pulls.
void add_curve(const GlyphPoint& b, const GlyphPoint& c, GlyphLine& line) {
  constexpr int kPieces = 8;
  const GlyphPoint a = line.back();
  for (int i = 1; i <= kPieces; ++i) {
    const double t = static_cast<double>(i) / kPieces;
    line.push_back(between(between(a, b, t), between(b, c, t), t));
  }
}

GlyphLine curve_of(const GlyphLine& points) {
  GlyphLine line{points.front()};
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const bool last = i + 2 == points.size();
    add_curve(points[i], last ? points[i + 1] : between(points[i], points[i + 1], 0.5), line);
  }
  return line;
}

GlyphLine loop_of(const GlyphLine& points) {
  GlyphLine line{between(points.back(), points.front(), 0.5)};
  for (std::size_t i = 0; i < points.size(); ++i)
    add_curve(points[i], between(points[i], points[(i + 1) % points.size()], 0.5), line);
  return line;
}

Glyph read(const Drawn& drawn) {
  Glyph glyph{drawn.width, {}};
  for (const char* at = drawn.lines; *at != '\0';) {
    const char kind = *at++;
    GlyphLine points;
    while (*at == ' ' && at[1] != 'l' && at[1] != 'b' && at[1] != 'o') {
      char* end = nullptr;
      const double x = std::strtod(at, &end);
      const double y = std::strtod(end + 1, &end);
      points.push_back({x, y});
      at = end;
    }
    if (*at == ' ') ++at;
    glyph.lines.push_back(kind == 'l' ? points : kind == 'b' ? curve_of(points) : loop_of(points));
  }
  return glyph;
}

struct Font {
  std::vector<Glyph> ascii;
  Glyph times = read(kDrawnTimes), box = read(kDrawnBox);

  Font() {
    for (const Drawn& drawn : kDrawn) ascii.push_back(read(drawn));
  }
};

}  // namespace

const Glyph& glyph_of(char32_t code) {
  static const Font kFont;
  if (code == kTimes) return kFont.times;
  if (code < 32 || code - 32 >= kFont.ascii.size()) return kFont.box;
  return kFont.ascii[code - 32];
}

std::vector<char32_t> code_points(const char* text) {
  std::vector<char32_t> codes;
  for (auto at = reinterpret_cast<const unsigned char*>(text); *at != 0;) {
    const unsigned char first = *at++;
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : 0;
    char32_t code = more == 0 ? first : first & (0x3F >> more);
    for (int k = 0; k < more && (*at & 0xC0) == 0x80; ++k) code = code << 6 | (*at++ & 0x3F);
    codes.push_back(code);
  }
  return codes;
}

}  // namespace pointskin::render_detail
