#include "fluid/band.hpp"

namespace pointskin::fluid {

octree::LevelView SparseLevel::view() const {
  octree::LevelView level;
  level.depth = depth;
  level.cell_bricks = level.bricks = static_cast<std::int32_t>(bricks());
  level.brick_key = brick_key.data();
  level.neighbours = neighbours.data();
  return level;
}

field::FieldView Band::field() const {
  field::FieldView view;
  view.tree.depth = fine.depth;
  view.tree.levels[fine.depth] = fine.view();
  view.tree.nodes = 8 * fine.bricks();
  view.values = fine.values.data();
  view.isovalue = 0;
  view.closed = false;  // the cube has a margin
  view.counts = counts.data();
  return view;
}

}  // namespace pointskin::fluid
