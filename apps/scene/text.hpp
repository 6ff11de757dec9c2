// Lines for people.
#pragma once

#include <string>

namespace pointskin::scene {

/// `text` with every run of line breaks (and spaces after them) replaced by "; ", other control characters by "?".
std::string one_line(const std::string& text);

}  // namespace pointskin::scene
