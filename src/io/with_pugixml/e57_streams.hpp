// The points of an E57 scan: packets, in which every field has a stream of bits of its own.
// Source: ASTM E2807-11, "3D imaging data exchange", clauses 9.3 and 9.7, and libE57Format.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/source.hpp"
#include "io/with_pugixml/e57_document.hpp"
#include "io/with_pugixml/e57_pages.hpp"

namespace pointskin::io {

/// The bytes of the stream of every field, with kE57Padding zeros behind it.
/// @throws Error invalid_input for packets that are garbled, or where a stream ends before the scan's points do
std::vector<std::string> read_e57_streams(const Source& source, const E57Pages& pages, const E57Scan& scan);

inline constexpr std::size_t kE57Padding = 16;

/// The value of the point `record` in the padded stream of a field that is no text.
double e57_value(const E57Field& field, const std::string& stream, std::uint64_t record);

}  // namespace pointskin::io
