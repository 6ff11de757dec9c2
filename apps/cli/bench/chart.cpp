#include "bench/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "json_text.hpp"

namespace pointskin::cli {
namespace {

// All lengths are pixels.
constexpr double kChartWidth = 560;
constexpr double kLeft = 70, kTop = 50, kPlotWidth = 460, kPlotHeight = 330;  // of the axes inside a chart
constexpr double kLegendTop = kTop + kPlotHeight + 66, kLegendRow = 20;
constexpr std::size_t kMostTicks = 8;

/// Told apart by people with any colour vision: M. Okabe & K. Ito, "Color universal design", 2008, less its yellow.
constexpr std::array kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"};

/// `text` inside an element or attribute.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : valid_utf8(text)) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
    }
  }
  return result;
}

std::string text_at(double x, double y, const char* anchor, const std::string& text, const char* more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more,
                     escaped(text));
}

std::string line_at(double x1, double y1, double x2, double y2, const char* colour) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2, y2,
                     colour);
}

/// Circle, square, triangle and diamond in turn.
std::string marker_at(double x, double y, std::size_t index, const char* colour) {
  constexpr std::array kShapes = {"m-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z", "m-4 -4h8v8h-8z", "m0 -5l5 9h-10z",
                                  "m0 -5.5l5.5 5.5l-5.5 5.5l-5.5 -5.5z"};
  return fmt::format("<path d=\"M{:.1f} {:.1f}{}\" fill=\"{}\"/>\n", x, y, kShapes[index % kShapes.size()], colour);
}

/// Share of the axis at which `value` lies, in [0, 1].
double share(const std::vector<Tick>& ticks, double value) {
  return std::log(value / ticks.front().value) / std::log(ticks.back().value / ticks.front().value);
}
double x_of(const Chart& chart, double value) { return kLeft + kPlotWidth * share(chart.x_ticks, value); }
double y_of(const Chart& chart, double value) { return kTop + kPlotHeight * (1 - share(chart.y_ticks, value)); }

std::string axes(const Chart& chart) {
  constexpr double kBottom = kTop + kPlotHeight, kRight = kLeft + kPlotWidth;
  std::string svg = text_at(kLeft, kTop - 20, "start", chart.title, " font-size=\"15\" font-weight=\"bold\"");
  for (const Tick& tick : chart.x_ticks) {
    const double x = x_of(chart, tick.value);
    svg += line_at(x, kTop, x, kBottom, "#dddddd") + text_at(x, kBottom + 20, "middle", tick.text);
  }
  for (const Tick& tick : chart.y_ticks) {
    const double y = y_of(chart, tick.value);
    svg += line_at(kLeft, y, kRight, y, "#dddddd") + text_at(kLeft - 8, y + 4, "end", tick.text);
  }
  svg += line_at(kLeft, kTop, kLeft, kBottom, "#444444") + line_at(kLeft, kBottom, kRight, kBottom, "#444444");
  return svg + text_at(kLeft + kPlotWidth / 2, kBottom + 42, "middle", chart.x_title);
}

/// The line with its markers, and its line of the legend.
std::string drawn(const Chart& chart, std::size_t index) {
  const Series& series = chart.series[index];
  const char* colour = kColours[index % kColours.size()];
  const char* dashes = series.dashed ? " stroke-dasharray=\"6 4\"" : "";
  const double row = kLegendTop + kLegendRow * static_cast<double>(index);
  std::string path, markers;
  for (const ChartPoint& point : series.points) {
    const double x = x_of(chart, point.x), y = y_of(chart, point.y);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x, y);
    markers += marker_at(x, y, index, colour);
  }
  path += fmt::format("M{:.1f} {:.1f}h36", kLeft, row - 4);
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", path, colour, dashes) +
         markers + marker_at(kLeft + 18, row - 4, index, colour) + text_at(kLeft + 46, row, "start", series.name);
}

/// The `mantissas` times powers of ten from the last one up to `least` to the first one from `most` on, at least two.
std::vector<double> covering(double least, double most, const std::vector<double>& mantissas) {
  constexpr double kSame = 1 + 1e-9;  // 10^k and its logarithm are rounded
  std::vector<double> ticks;
  const auto is_short = [&] { return ticks.size() < 2 || ticks.back() * kSame < most; };
  for (int decade = static_cast<int>(std::floor(std::log10(least))) - 1; is_short(); ++decade) {
    for (const double mantissa : mantissas) {
      const double tick = mantissa * std::pow(10.0, decade);
      if (tick <= least * kSame) ticks.clear();  // only the last one of these is needed
      if (is_short()) ticks.push_back(tick);
    }
  }
  return ticks;
}

}  // namespace

std::vector<double> log_ticks(double least, double most) {
  const std::vector<double> fine = covering(least, most, {1, 2, 5});
  if (fine.size() <= kMostTicks) return fine;
  const std::vector<double> decades = covering(least, most, {1});
  const std::size_t step = (decades.size() + kMostTicks - 2) / (kMostTicks - 1);
  std::vector<double> ticks;
  for (std::size_t i = 0; i < decades.size(); i += step) ticks.push_back(decades[i]);
  if (ticks.back() < decades.back()) ticks.push_back(ticks.back() * std::pow(10.0, static_cast<double>(step)));
  return ticks;
}

std::string to_svg(const std::vector<Chart>& charts) {
  std::size_t rows = 0;
  for (const Chart& chart : charts) rows = std::max(rows, chart.series.size());
  const double width = kChartWidth * static_cast<double>(charts.size());
  const double height = kLegendTop + kLegendRow * static_cast<double>(rows);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"13\" fill=\"#222222\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      width, height);
  for (std::size_t c = 0; c < charts.size(); ++c) {
    svg += fmt::format("<g transform=\"translate({:.0f} 0)\">\n", kChartWidth * static_cast<double>(c));
    svg += axes(charts[c]);
    for (std::size_t i = 0; i < charts[c].series.size(); ++i) svg += drawn(charts[c], i);
    svg += "</g>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace pointskin::cli
