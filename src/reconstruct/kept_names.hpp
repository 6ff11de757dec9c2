// What the attributes of a cloud are called on the mesh.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>

namespace pointskin::detail {

/// Names of the attributes on a mesh, in their order. A name that the mesh has itself (x, y, z, nx, ny, nz, with
/// `density` also density, with `weakness` that) or that came before gets `input_` in front, until it is free.
inline std::vector<std::string> kept_names(const std::vector<Attribute>& attributes, bool density,
                                           bool weakness = false) {
  std::vector<std::string> taken = {"x", "y", "z", "nx", "ny", "nz"};
  if (density) taken.emplace_back("density");
  if (weakness) taken.emplace_back("weakness");
  const auto own = static_cast<std::ptrdiff_t>(taken.size());
  for (const Attribute& attribute : attributes) {
    std::string name = attribute.name;
    while (std::find(taken.begin(), taken.end(), name) != taken.end()) name.insert(0, "input_");
    taken.push_back(std::move(name));
  }
  return {taken.begin() + own, taken.end()};
}

}  // namespace pointskin::detail
