// Charts with logarithmic axes, as SVG.
#pragma once

#include <string>
#include <vector>

namespace pointskin::cli {

/// Where a line of the grid is, and what is written beside it.
struct Tick {
  double value = 0;
  std::string text;
};

struct ChartPoint {
  double x = 0, y = 0;  ///< > 0
};

/// A line through points with markers.
struct Series {
  std::string name;
  bool dashed = false;
  std::vector<ChartPoint> points;
};

/// One pair of axes. The first and last ticks are the ends of the axis; all points lie between them.
struct Chart {
  std::string title, x_title;
  std::vector<Tick> x_ticks, y_ticks;
  std::vector<Series> series;
};

/// Round values that cover [least, most] on a logarithmic axis, ascending, at least 2 and at most 8: of the form 1, 2,
/// 5 times a power of ten where these are few enough, else powers of ten, every one or every k-th.
/// @param least, most  0 < least <= most, finite
std::vector<double> log_ticks(double least, double most);

/// The charts side by side, each with its legend below, on white.
std::string to_svg(const std::vector<Chart>& charts);

}  // namespace pointskin::cli
