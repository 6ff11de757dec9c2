// Whether bytes are text that JSON can hold.
#pragma once

#include <string_view>

namespace pointskin::studio {

/// RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text);

}  // namespace pointskin::studio
