// Options that take other ways through a reconstruction, one set for each.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/shapes.hpp"

namespace pointskin::test {

/// What each set is called, and the set. The shape is expected within [-2, 2]^3.
inline std::vector<std::pair<std::string, Options>> option_sets(int depth, bool with_offset) {
  std::vector<std::pair<std::string, Options>> sets;
  const auto add = [&](const char* name, const auto& change) {
    Options options{{.depth = depth}};
    change(options);
    sets.emplace_back(name, options);
  };
  add("defaults", [](Options&) {});
  add("attributes", [](Options& o) { o.attributes = o.density = o.confidence = true; });
  add("trim", [](Options& o) { o.trim = 0.05; });
  add("weakness", [](Options& o) { o.weakness = true; });
  add("distance", [](Options& o) { o.field = FieldKind::distance; });
  add("open, no normals", [](Options& o) { o.domain_faces = DomainFaces::open, o.normals = false; });
  add("dirichlet, fixed",
      [](Options& o) { o.boundary = Boundary::dirichlet, o.fixed_screening = o.linear_fit = true; });
  add("unscreened", [](Options& o) { o.screening = 0; });
  add("envelope", [](Options& o) {
    o.envelope = std::make_shared<const Mesh>(box_mesh({-1.9, -0.6, -1.9}, {1.9, 1.9, 1.9}));
  });
  if (with_offset) {
    add("offset", [](Options& o) { o.offset = 0.1; });
    add("offset of distance", [](Options& o) { o.offset = -0.05, o.field = FieldKind::distance; });
  }
  return sets;
}

}  // namespace pointskin::test
