// How mesh files without a magic number are recognised.
#pragma once

#include <string_view>

namespace pointskin::io {

/// True if the first word of `text` is an OFF keyword.
bool looks_like_off(std::string_view text);

/// True if the length fits a binary STL file, or the text starts with "solid".
bool looks_like_stl(std::string_view bytes);

}  // namespace pointskin::io
