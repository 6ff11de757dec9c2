// Maps are built in Oklab, in which equal distances look about equally different.
// Sources: Ottosson, "A perceptual color space for image processing", 2020 (Oklab); Smith & van der Walt, "A better
// default colormap for Matplotlib", SciPy 2015 (viridis, whose path the sequential map follows: lightness rises evenly
// from dark violet to yellow, no red beside green); Moreland, "Diverging color maps for scientific visualization", ISVC
// 2009 (two hues of equal lightness that meet in a light grey).
#include "render/colour_map.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pointskin::render_detail {
namespace {

/// Lightness, chroma and hue (degrees) of Oklab.
struct Tone {
  double lightness, chroma, hue;
};

Colour from_oklab(double l, double a, double b) {
  const double x = std::pow(l + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double y = std::pow(l - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double z = std::pow(l - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * x - 3.3077115913 * y + 0.2309699292 * z,
          -1.2684380046 * x + 2.6097574011 * y - 0.3413193965 * z,
          -0.0041960863 * x - 0.7034186147 * y + 1.7076147010 * z};
}

struct Lab {
  double l, a, b;
};

Lab lab_of(const Tone& tone) {
  const double angle = tone.hue * std::numbers::pi / 180;
  return {tone.lightness, tone.chroma * std::cos(angle), tone.chroma * std::sin(angle)};
}

Lab mixed_lab(const Lab& p, const Lab& q, double t) {
  return {p.l + t * (q.l - p.l), p.a + t * (q.a - p.a), p.b + t * (q.b - p.b)};
}

double distance(const Lab& p, const Lab& q) { return std::hypot(p.l - q.l, p.a - q.a, p.b - q.b); }

Colour colour_of(const Lab& lab) {
  Colour colour = from_oklab(lab.l, lab.a, lab.b);
  for (std::size_t c = 0; c < 3; ++c) colour[c] = std::clamp(colour[c], 0.0, 1.0);
  return colour;
}

/// The sequential map's path, from its control tones, at `u` in [0, 1].
Lab sequential_path(double u) {
  constexpr std::array<Tone, 5> kTones = {
      {{0.29, 0.125, 306}, {0.45, 0.115, 266}, {0.61, 0.102, 205}, {0.77, 0.150, 148}, {0.93, 0.175, 107}}};
  // Catmull-Rom over the tones; chroma and hue turn smoothly, lightness is a line.
  const double at = u * (kTones.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kTones.size() - 2);
  const double t = at - static_cast<double>(i);
  const Tone& p1 = kTones[i];
  const Tone& p2 = kTones[i + 1];
  const Tone& p0 = i > 0 ? kTones[i - 1] : p1;
  const Tone& p3 = i + 2 < kTones.size() ? kTones[i + 2] : p2;
  const auto smooth = [t](double a, double b, double c, double d) {
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
  };
  return lab_of({p1.lightness + t * (p2.lightness - p1.lightness), smooth(p0.chroma, p1.chroma, p2.chroma, p3.chroma),
                 smooth(p0.hue, p1.hue, p2.hue, p3.hue)});
}

/// Points of the path at equal distances along it.
class EvenPath {
 public:
  EvenPath() {
    constexpr int kFine = 2000;
    std::vector<Lab> fine(kFine + 1);
    std::vector<double> length(kFine + 1, 0);
    for (std::size_t i = 0; i < fine.size(); ++i) {
      fine[i] = sequential_path(static_cast<double>(i) / kFine);
      if (i > 0) length[i] = length[i - 1] + distance(fine[i - 1], fine[i]);
    }
    std::size_t i = 0;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const double wanted = length.back() * static_cast<double>(k) / static_cast<double>(points_.size() - 1);
      while (i + 2 < fine.size() && length[i + 1] < wanted) ++i;
      points_[k] = mixed_lab(fine[i], fine[i + 1], (wanted - length[i]) / (length[i + 1] - length[i]));
    }
  }

  [[nodiscard]] Lab at(double t) const {
    const double place = std::clamp(t, 0.0, 1.0) * static_cast<double>(points_.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(place), points_.size() - 2);
    return mixed_lab(points_[i], points_[i + 1], place - static_cast<double>(i));
  }

 private:
  std::array<Lab, 257> points_{};
};

/// Whether the range lies on both sides of 0, by a tenth of the larger side at least.
bool has_two_signs(const ValueRange& range) {
  return range.low < 0 && range.high > 0 && std::min(-range.low, range.high) >= 0.1 * std::max(-range.low, range.high);
}

ValueRange widened(const ValueRange& range) {
  if (range.low < range.high) return range;
  const double half = range.low == 0 ? 0.5 : std::abs(range.low) / 2;
  return {range.low - half, range.high + half};
}

std::string names_of(const Vertices& vertices) {
  std::string names;
  for (const Attribute& attribute : vertices.attributes)
    if (attribute.values.size() == vertices.size()) names += attribute.name + ", ";
  return names + "x, y, z";
}

}  // namespace

Colour sequential_colour(double t) {
  static const EvenPath kPath;
  return colour_of(kPath.at(t));
}

Colour diverging_colour(double t) {
  constexpr Tone kBlue{0.55, 0.155, 258}, kOrange{0.60, 0.13, 62};
  constexpr Lab kMiddle{0.95, 0, 0};
  return colour_of(mixed_lab(kMiddle, lab_of(t < 0 ? kBlue : kOrange), std::min(std::abs(t), 1.0)));
}

Colour no_value_colour() { return from_srgb(0.60, 0.60, 0.60); }

ValueView find_values(const Vertices& vertices, const std::string& name) {
  if (const Attribute* attribute = vertices.find(name)) return {.values = &attribute->values};
  constexpr std::array<float Vec3f::*, 3> kAxes = {&Vec3f::x, &Vec3f::y, &Vec3f::z};
  for (std::size_t a = 0; a < 3; ++a) {
    if (name == std::string(1, "xyz"[a]))
      return {.places = &vertices.positions, .axis = kAxes[a], .offset = vertices.origin[a]};
  }
  throw Error(ErrorCode::usage, std::string("the ") + vertices.owner + " has no attribute '" + name +
                                    "' to colour by; there are " + names_of(vertices));
}

std::optional<ValueRange> usual_range(const ValueView& values) {
  std::vector<double> finite;
  finite.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values.stored(i))) finite.push_back(values.stored(i));
  if (finite.empty()) return std::nullopt;
  const auto rank = [&](double share) {
    const auto at = static_cast<std::ptrdiff_t>(std::floor(share * static_cast<double>(finite.size() - 1) + 0.5));
    std::nth_element(finite.begin(), finite.begin() + at, finite.end());
    return values.offset + finite[static_cast<std::size_t>(at)];
  };
  const ValueRange range{rank(0.01), rank(0.99)};
  return range.low < range.high ? range : ValueRange{rank(0), rank(1)};
}

ColourScale::ColourScale(const ValueView& values, const ValueRange& range, ColourMap map)
    : range_(widened(range)), stored_low_(range_.low - values.offset), per_value_(1 / (range_.high - range_.low)) {
  look_at(values);
  const bool automatic = map == ColourMap::automatic && !values.is_coordinate() && has_two_signs(range_);
  const bool diverging = map == ColourMap::diverging || automatic;
  const double largest = std::max(std::abs(range_.low), std::abs(range_.high));
  for (std::size_t i = 0; i <= kTableSize; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(kTableSize);
    const double value = range_.low + t * (range_.high - range_.low);
    table_.push_back(diverging ? diverging_colour(value / largest) : sequential_colour(t));
  }
}

ColourScale::ColourScale(const ValueView& values, const ValueRange& range, Colour (*colour)(double))
    : range_(widened(range)), stored_low_(range_.low - values.offset), per_value_(1 / (range_.high - range_.low)) {
  look_at(values);
  for (std::size_t i = 0; i <= kTableSize; ++i)
    table_.push_back(colour(static_cast<double>(i) / static_cast<double>(kTableSize)));
}

void ColourScale::look_at(const ValueView& values) {
  const double stored_high = range_.high - values.offset;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double stored = values.stored(i);
    goes_below_ = goes_below_ || stored < stored_low_;
    goes_above_ = goes_above_ || stored > stored_high;
    has_none_ = has_none_ || std::isnan(stored);
  }
}

const Colour& ColourScale::at(double t) const {
  return table_[static_cast<std::size_t>(std::clamp(t, 0.0, 1.0) * static_cast<double>(kTableSize) + 0.5)];
}

const Colour& ColourScale::of_stored(double stored) const {
  return std::isnan(stored) ? none_ : at((stored - stored_low_) * per_value_);
}

}  // namespace pointskin::render_detail
