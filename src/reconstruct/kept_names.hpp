// What the attributes of a cloud are called on the mesh.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace pointskin::detail {

/// Names of the attributes on a mesh, in their order. A name that the mesh has itself (x, y, z, nx, ny, nz, with
/// `density` also density, with `weakness` that) or that came before gets `input_` in front, until it is free.
/// @param names  that the points give them
inline std::vector<std::string> kept_names(const std::vector<std::string>& names, bool density, bool weakness) {
  std::vector<std::string> taken = {"x", "y", "z", "nx", "ny", "nz"};
  if (density) taken.emplace_back("density");
  if (weakness) taken.emplace_back("weakness");
  const auto own = static_cast<std::ptrdiff_t>(taken.size());
  for (std::string name : names) {
    while (std::find(taken.begin(), taken.end(), name) != taken.end()) name.insert(0, "input_");
    taken.push_back(std::move(name));
  }
  return {taken.begin() + own, taken.end()};
}

}  // namespace pointskin::detail
