#include "render/paint.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>

namespace pointskin::render_detail {
namespace {

using mesh_detail::plus;
using mesh_detail::times;

/// A multiple of 255, so that bytes fall on entries.
constexpr int kDecodedSteps = 255 * 16;

bool counts_to_255(const Attribute& channel) {
  return channel.type == AttributeType::uint8 ||
         std::any_of(channel.values.begin(), channel.values.end(), [](float v) { return v > 1; });
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
  bool to_255 = false;
  for (const char* name : kNames) {
    const Attribute* const channel = vertices.find(name);
    if (channel == nullptr) return;
    to_255 = to_255 || counts_to_255(*channel);
  }
  for (std::size_t k = 0; k < 3; ++k) channels_[k] = vertices.find(kNames[k])->values.data();
  to_table_ = static_cast<float>(kDecodedSteps) / (to_255 ? 255.0F : 1.0F);
  for (int i = 0; i <= kDecodedSteps; ++i)
    decoded_.push_back(static_cast<float>(decode_srgb(static_cast<double>(i) / kDecodedSteps)));
}

Colour Paint::channels(std::size_t vertex) const {
  Colour colour{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float place = channels_[k][vertex] * to_table_;
    if (std::isnan(place)) return clay_;
    colour[k] = decoded_[static_cast<std::size_t>(std::clamp(place, 0.0F, float{kDecodedSteps}) + 0.5F)];
  }
  return colour;
}

Colour Paint::at(std::size_t vertex) const {
  if (scale_) return scale_->of_stored(static_cast<double>(values_.stored(vertex)));
  return channels_[0] != nullptr ? channels(vertex) : clay_;
}

Colour Paint::at(const Triangle& t, const Vec3d& weights) const {
  const std::size_t ids[3] = {static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                              static_cast<std::size_t>(t[2])};
  if (scale_) {
    double value = 0;
    for (std::size_t k = 0; k < 3; ++k) value += weights[k] * static_cast<double>(values_.stored(ids[k]));
    return scale_->of_stored(value);
  }
  if (channels_[0] == nullptr) return clay_;
  Colour sum{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) sum = plus(sum, times(weights[k], channels(ids[k])));
  return sum;
}

}  // namespace pointskin::render_detail
