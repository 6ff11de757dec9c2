#include "poisson/boundary.hpp"

#include "exec/this_space.hpp"
#include "octree/keys.hpp"
#include "octree/placed.hpp"

namespace pointskin::poisson {
namespace {

/// The unknowns of a brick, without those on the faces if these are held.
struct FreeUnknowns {
  octree::OctreeView tree;
  bool hold_faces;
  ArrayView<std::uint8_t> out;

  PSK_HD void operator()(std::int64_t brick_of_all) const {
    const octree::LevelView& level = tree.levels[tree.level_of(8 * brick_of_all)];
    const std::int64_t brick = brick_of_all - level.first_node / 8;
    const unsigned unknowns = level.unknowns[brick];
    out[brick_of_all] = static_cast<std::uint8_t>(hold_faces ? unknowns & ~on_faces(level, brick) : unknowns);
  }

  /// Bit s: the corner of node s lies on a face of the cube.
  [[nodiscard]] PSK_HD static unsigned on_faces(const octree::LevelView& level, std::int64_t brick) {
    const octree::Coordinates b = octree::decode(level.brick_key[brick]);
    const std::int32_t last = 1 << level.depth;
    unsigned mask = 0;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const std::int32_t x = 2 * b.x + octree::slot_x(s);
      const std::int32_t y = 2 * b.y + octree::slot_y(s);
      const std::int32_t z = 2 * b.z + octree::slot_z(s);
      if (x == 0 || y == 0 || z == 0 || x == last || y == last || z == last) mask |= 1U << s;
    }
    return mask;
  }
};

}  // namespace

template <exec::Space Exec>
exec::Buffer<std::uint8_t> free_unknowns(Exec& ex, const octree::OctreeView& tree, bool hold_faces) {
  const auto placed = octree::placed_on_levels(ex, tree, tree.depth);
  auto out = exec::make_buffer<std::uint8_t>(ex, tree.nodes / 8);
  for_each(ex, "solve.free", out.size(), FreeUnknowns{tree, hold_faces, out.view()});
  return out;
}

PSK_INSTANTIATE(free_unknowns);

}  // namespace pointskin::poisson
