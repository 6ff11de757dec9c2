// What the XML of E57 files says of scans. Source: ASTM E2807-11, "3D imaging data exchange", clause 8.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/attribute.hpp>
#include <pointskin/vector.hpp>

#include "io/source.hpp"
#include "io/with_pugixml/e57_pages.hpp"

namespace pointskin::io {

enum class E57Coding { integer, scaled, float32, float64, text };

/// One value of every point.
struct E57Field {
  std::string name;
  E57Coding coding = E57Coding::float64;
  std::int64_t minimum = std::numeric_limits<std::int64_t>::min();  ///< of the integers that are stored
  std::int64_t maximum = std::numeric_limits<std::int64_t>::max();
  double scale = 1, offset = 0;  ///< value = scale * stored + offset

  /// That a value takes in its stream; 0 if all values are the minimum.
  [[nodiscard]] unsigned bits() const;
  /// The smallest that holds all values; float64 where integers exceed 2^53.
  [[nodiscard]] AttributeType type() const;
};

/// Where a scan lies: world = rotation * point + translation.
struct E57Pose {
  std::array<Vec3d, 3> rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< its rows
  Vec3d translation{0, 0, 0};

  [[nodiscard]] Vec3d rotated(const Vec3d& v) const;
  friend bool operator==(const E57Pose&, const E57Pose&) = default;
};

struct E57Scan {
  std::uint64_t place = 0;  ///< in the file, of its points
  std::uint64_t records = 0;
  std::vector<E57Field> fields;
  E57Pose pose;
  std::array<std::array<double, 2>, 3> colour_limits{};  ///< of red, green and blue: black and white

  /// The number of the field with this name, if there is one.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  /// Those with these names, if all are there.
  [[nodiscard]] std::optional<std::array<std::size_t, 3>> find(const std::array<const char*, 3>& names) const;
};

/// The scans that have points.
/// @throws Error invalid_input for XML that is garbled or lacks what the standard demands
std::vector<E57Scan> parse_e57_document(const Source& source, const E57Pages& pages);

}  // namespace pointskin::io
