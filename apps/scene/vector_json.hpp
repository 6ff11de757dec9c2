// Vectors in JSON reports.
#pragma once

#include <pointskin/vector.hpp>

namespace pointskin {

/// `v` as [x, y, z]; nlohmann::basic_json finds this when a vector is assigned to it.
template <class Json>
void to_json(Json& json, const Vec3d& v) {
  json = Json::array({v.x, v.y, v.z});
}

}  // namespace pointskin
