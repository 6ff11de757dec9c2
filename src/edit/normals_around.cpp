#include "edit/normals_around.hpp"

#include <cmath>

#include "exec/this_space.hpp"
#include "octree/access.hpp"

namespace pointskin::edit {
namespace {

/// Samples of a cell as one: sums over those that count.
struct Cluster {
  float x = 0, y = 0, z = 0;     ///< of positions
  float nx = 0, ny = 0, nz = 0;  ///< of normals
  float count = 0;

  PSK_HD void add(const Cluster& other) {
    x += other.x;
    y += other.y;
    z += other.z;
    nx += other.nx;
    ny += other.ny;
    nz += other.nz;
    count += other.count;
  }
};

PSK_HD Cluster cluster_of(const NormalSamples& samples, std::int32_t s) {
  if (!samples.counts.empty() && samples.counts[s] == 0) return {};
  const Vec3f p = samples.positions[s];
  const Vec3f n = samples.normals[s];
  return {p.x, p.y, p.z, n.x, n.y, n.z, 1};
}

struct CollectFinest {
  NormalSamples samples;
  ArrayView<Cluster> clusters;  // of the level
  PSK_HD void operator()(std::int64_t cell) const {
    const octree::LevelView& level = samples.tree.finest();
    Cluster sum;
    for (std::int32_t s = level.point_begin[cell]; s < level.point_begin[cell + 1]; ++s)
      sum.add(cluster_of(samples, s));
    clusters[cell] = sum;
  }
};

/// All samples lie in finest cells: a cell without children holds none.
struct CollectChildren {
  octree::OctreeView tree;
  int depth;
  ArrayView<const Cluster> below;
  ArrayView<Cluster> clusters;
  PSK_HD void operator()(std::int64_t cell) const {
    Cluster sum;
    if (tree.is_split(depth, cell)) {
      const std::int64_t first = std::int64_t{8} * tree.levels[depth].child_brick[cell];
      PSK_UNROLL
      for (int s = 0; s < 8; ++s) sum.add(below[first + s]);
    }
    clusters[cell] = sum;
  }
};

struct Interpolate {
  NormalSamples samples;
  ArrayView<const Cluster> clusters;  // of all levels
  octree::Frame cube;
  ArrayView<const Vec3f> points;
  ArrayView<Vec3f> normals;

  struct Sum {
    double x = 0, y = 0, z = 0;
    bool found = false;
  };

  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = cube.to_unit(points[i]);
    octree::Leaf leaf = octree::locate(samples.tree, octree::point_key(p.x, p.y, p.z), samples.tree.depth);
    Sum sum;
    while (true) {
      add_box(p, leaf, sum);
      if (sum.found || leaf.depth == 0) break;
      leaf.cell = samples.tree.levels[leaf.depth].parent[leaf.cell >> 3];
      --leaf.depth;
    }
    const double length = std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
    const double inverse = length > 0 ? 1 / length : 0;
    normals[i] = {static_cast<float>(sum.x * inverse), static_cast<float>(sum.y * inverse),
                  static_cast<float>(sum.z * inverse)};
  }

  [[nodiscard]] PSK_HD const Cluster& cluster(int depth, std::int32_t cell) const {
    return clusters[samples.tree.levels[depth].first_node + cell];
  }

  PSK_HD void add_box(const Vec3f& p, const octree::Leaf& leaf, Sum& sum) const {
    const octree::LevelView& level = samples.tree.levels[leaf.depth];
    for (int j = 0; j < octree::kNeighbours; ++j) {
      const std::int32_t cell = level.neighbour(leaf.cell, j / 9 - 1, j / 3 % 3 - 1, j % 3 - 1);
      if (!level.is_cell(cell) || !(cluster(leaf.depth, cell).count > 0)) continue;
      if (leaf.depth == samples.tree.depth) {
        for (std::int32_t s = level.point_begin[cell]; s < level.point_begin[cell + 1]; ++s)
          add(p, cluster_of(samples, s), sum);
      } else {  // it has children, for it holds samples
        const std::int32_t first = 8 * level.child_brick[cell];
        for (int s = 0; s < 8; ++s) add(p, cluster(leaf.depth + 1, first + s), sum);
      }
    }
  }

  PSK_HD static void add(const Vec3f& p, const Cluster& c, Sum& sum) {
    if (!(c.count > 0)) return;
    const double inverse = 1 / static_cast<double>(c.count);
    const double x = c.x * inverse - p.x;
    const double y = c.y * inverse - p.y;
    const double z = c.z * inverse - p.z;
    // At the sample itself the weight would be infinite: it is that of a distance below a float's resolution.
    const double weight = 1 / (x * x + y * y + z * z + 1e-16);
    sum.x += weight * c.nx;
    sum.y += weight * c.ny;
    sum.z += weight * c.nz;
    sum.found = true;
  }
};

}  // namespace

template <exec::Space Exec>
exec::Buffer<Vec3f> interpolate_normals(Exec& ex, const NormalSamples& samples, const octree::Frame& cube,
                                        ArrayView<const Vec3f> points) {
  const octree::OctreeView& tree = samples.tree;
  auto clusters = exec::make_buffer<Cluster>(ex, tree.nodes);
  const auto of_level = [&](int d) { return clusters.view().part(tree.levels[d].first_node, tree.levels[d].cells()); };
  for_each(ex, "guide.clusters", tree.finest().cells(), CollectFinest{samples, of_level(tree.depth)});
  for (int d = tree.depth - 1; d >= 0; --d)
    for_each(ex, "guide.clusters", tree.levels[d].cells(), CollectChildren{tree, d, of_level(d + 1), of_level(d)});
  auto normals = exec::make_buffer<Vec3f>(ex, points.size);
  for_each(ex, "guide.normals", points.size, Interpolate{samples, clusters.cview(), cube, points, normals.view()});
  return normals;
}

PSK_INSTANTIATE(interpolate_normals);

}  // namespace pointskin::edit
