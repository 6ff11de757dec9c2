// Colours of values.
#pragma once

#include <pointskin/render.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "render/colour.hpp"
#include "render/vertices.hpp"

namespace pointskin::render_detail {

/// Colour at `t` in [0, 1] of a map that runs from dark violet over blue and green to yellow, evenly darker to lighter.
Colour sequential_colour(double t);
/// Colour at `t` in [-1, 1] of a map that runs from blue over a light grey to orange.
Colour diverging_colour(double t);
/// Where there is no value.
Colour no_value_colour();

/// The values of an attribute, or a coordinate. What they are of must outlive it.
struct ValueView {
  const AttributeValues* values = nullptr;     ///< null: of a coordinate
  const std::vector<Vec3f>* places = nullptr;  ///< of a coordinate
  float Vec3f::*axis = nullptr;
  double offset = 0;  ///< added to what is stored, so that coordinates keep their digits

  [[nodiscard]] bool is_coordinate() const { return values == nullptr; }
  [[nodiscard]] std::size_t size() const { return is_coordinate() ? places->size() : values->size(); }
  /// NaN where there is none.
  [[nodiscard]] double stored(std::size_t i) const {
    return is_coordinate() ? static_cast<double>((*places)[i].*axis) : values->at(i);
  }
};

/// @throws Error usage, listing what there is, if nothing is called `name`
ValueView find_values(const Vertices& vertices, const std::string& name);

/// See value_range() of render.hpp.
std::optional<ValueRange> usual_range(const ValueView& values);

/// A map over a range.
class ColourScale {
 public:
  /// @param range  low < high, or equal: then it is widened
  ColourScale(const ValueView& values, const ValueRange& range, ColourMap map);
  /// @param colour  of `t` in [0, 1] along the range
  ColourScale(const ValueView& values, const ValueRange& range, Colour (*colour)(double));

  /// Colour of a value as it is stored, that is without the offset; NaN is neutral grey.
  [[nodiscard]] const Colour& of_stored(double stored) const;
  /// Colour at `t` in [0, 1] from the low to the high end.
  [[nodiscard]] const Colour& at(double t) const;

  [[nodiscard]] const ValueRange& range() const { return range_; }
  [[nodiscard]] bool goes_below() const { return goes_below_; }  ///< there are values below the range
  [[nodiscard]] bool has_none() const { return has_none_; }      ///< somewhere there is no value
  [[nodiscard]] bool goes_above() const { return goes_above_; }

 private:
  static constexpr std::size_t kTableSize = 1024;

  void look_at(const ValueView& values);

  ValueRange range_;
  double stored_low_, per_value_;
  bool goes_below_ = false, goes_above_ = false, has_none_ = false;
  std::vector<Colour> table_;
  Colour none_ = no_value_colour();
};

}  // namespace pointskin::render_detail
