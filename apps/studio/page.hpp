// The files of the page, which are a part of the program: see cmake/PointskinPage.cmake.
#pragma once

#include <optional>
#include <string_view>

#include "studio/server/server.hpp"

namespace pointskin::studio {

/// The file of this name, such as "index.html"; unset if there is none.
std::optional<server::Asset> page_file(std::string_view name);

}  // namespace pointskin::studio
