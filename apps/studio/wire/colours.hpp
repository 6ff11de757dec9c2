// Colours of points and vertices, as bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pointskin/attribute.hpp>

namespace pointskin::studio::wire {

/// Red, green, blue and 255 of every element, shape (4 size); (0) unless all three attributes are there. Floats are
/// shares of 1, integers of 16 bits are divided by 257.
std::vector<std::uint8_t> colours_of(const std::vector<Attribute>& attributes, std::size_t size);

}  // namespace pointskin::studio::wire
