#include "render/paint.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace pointskin::render_detail {
namespace {

/// A multiple of 255, so that bytes fall on entries.
constexpr int kDecodedSteps = 255 * 16;

/// What is white: the most that bytes and numbers of 16 bits hold, else 1 or, if one is larger, 255.
double white_of(const std::array<const Attribute*, 3>& channels) {
  double white = 1;
  for (const Attribute* channel : channels) {
    if (channel->type() == AttributeType::uint16) return 65535;
    const bool exceeds = channel->values.visit(
        [](const auto& values) { return std::any_of(values.begin(), values.end(), [](auto v) { return v > 1; }); });
    if (channel->type() == AttributeType::uint8 || exceeds) white = 255;
  }
  return white;
}

}  // namespace

Colour clay() { return from_srgb(0.80, 0.775, 0.745); }

Colour behind() { return from_srgb(0.78, 0.30, 0.25); }

Paint::Paint(const Vertices& vertices, const RenderOptions& options) {
  if (options.colour_by.empty()) {
    if (options.colours) use_channels(vertices);
    return;
  }
  values_ = find_values(vertices, options.colour_by);
  const std::optional<ValueRange> range = options.range ? options.range : usual_range(values_);
  scale_.emplace(values_, range.value_or(ValueRange{0, 1}), options.colour_map);
}

void Paint::use_channels(const Vertices& vertices) {
  constexpr const char* kNames[3] = {"red", "green", "blue"};
  std::array<const Attribute*, 3> found{};
  for (std::size_t k = 0; k < 3; ++k) {
    found[k] = vertices.find(kNames[k]);
    if (found[k] == nullptr) return;
  }
  for (std::size_t k = 0; k < 3; ++k) channels_[k] = &found[k]->values;
  to_table_ = kDecodedSteps / white_of(found);
  for (int i = 0; i <= kDecodedSteps; ++i)
    decoded_.push_back(static_cast<float>(decode_srgb(static_cast<double>(i) / kDecodedSteps)));
}

Colour Paint::channels(std::size_t vertex) const {
  Colour colour{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double place = channels_[k]->at(vertex) * to_table_;
    if (std::isnan(place)) return clay_;
    colour[k] = decoded_[static_cast<std::size_t>(std::clamp(place, 0.0, double{kDecodedSteps}) + 0.5)];
  }
  return colour;
}

Colour Paint::at(std::size_t vertex) const {
  if (scale_) return scale_->of_stored(values_.stored(vertex));
  return channels_[0] != nullptr ? channels(vertex) : clay_;
}

Colour Paint::at(const Triangle& t, const Vec3d& weights) const {
  const std::size_t ids[3] = {static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                              static_cast<std::size_t>(t[2])};
  if (scale_) {
    double value = 0;
    for (std::size_t k = 0; k < 3; ++k) value += weights[k] * values_.stored(ids[k]);
    return scale_->of_stored(value);
  }
  if (channels_[0] == nullptr) return clay_;
  Colour sum{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) sum += weights[k] * channels(ids[k]);
  return sum;
}

}  // namespace pointskin::render_detail
