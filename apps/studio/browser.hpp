// Starts the browser of the desktop.
#pragma once

#include <string>

namespace pointskin::studio {

/// Asks the desktop to show `url`, by xdg-open. Does not wait for it.
/// @returns false if there is no display, or no xdg-open
bool open_browser(const std::string& url);

}  // namespace pointskin::studio
