// The corners inside at the ends of crossed edges, for those who move vertices along their edges.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "field/field_view.hpp"
#include "surface/edge_vertex.hpp"

namespace pointskin::surface {

struct InsideEnds {
  field::FieldView f;
  ArrayView<const std::uint64_t> items;  ///< of each vertex: its edge's node of all levels << 2 | its axis
  ArrayView<Vec3f> ends;                 ///< in the unit cube

  PSK_HD void operator()(std::int64_t vertex) const {
    const auto index = static_cast<std::int64_t>(items[vertex] >> 2);
    const int level = f.tree.level_of(index);
    const octree::LevelView& l = f.tree.levels[level];
    const auto node = static_cast<std::int32_t>(index - l.first_node);
    const auto axis = static_cast<int>(items[vertex] & 3);
    octree::Coordinates c = octree::decode(l.node_key(node));
    if (!f.inside(level, node, c)) {
      c.x += axis == 0;
      c.y += axis == 1;
      c.z += axis == 2;
    }
    const float width = 1.0F / static_cast<float>(1 << level);
    ends[vertex] = {static_cast<float>(c.x) * width, static_cast<float>(c.y) * width, static_cast<float>(c.z) * width};
  }
};

}  // namespace pointskin::surface
