// Lines for people, and numbers that people write.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <pointskin/vector.hpp>

namespace pointskin::scene {

/// `text` with every run of line breaks (and spaces after them) replaced by "; ", other control characters by "?".
std::string one_line(const std::string& text);

/// Reads a finite number at the start of `text` and moves `text` behind it. Does not depend on the locale.
std::optional<double> take_number(std::string_view& text);

/// `text` as a finite number; unset if it is anything else. Does not depend on the locale.
std::optional<double> parse_number(const std::string& text);

/// "x,y,z": three finite numbers; unset if it is anything else.
std::optional<Vec3d> parse_vector(const std::string& text);

}  // namespace pointskin::scene
