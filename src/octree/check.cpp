// The rules come from the definitions in octree_data.hpp and view.hpp, not from the way build.cpp gets there:
// whatever has a position is looked up by its key.
#include "octree/check.hpp"

#include <algorithm>
#include <unordered_map>

namespace pointskin::octree {

OctreeView HostOctree::view() const {
  OctreeView tree;
  tree.depth = depth;
  for (int d = 0; d <= depth; ++d) {
    const HostLevel& host = levels[static_cast<std::size_t>(d)];
    LevelView& level = tree.levels[d];
    level.depth = d;
    level.cell_bricks = host.cell_bricks;
    level.bricks = host.bricks;
    level.first_node = tree.nodes;
    level.brick_key = host.brick_key.data();
    level.parent = host.parent.data();
    level.neighbours = host.neighbours.data();
    level.child_brick = host.child_brick.data();
    level.unknowns = host.unknowns.data();
    level.point_begin = host.point_begin.data();
    tree.nodes += level.nodes();
  }
  return tree;
}

namespace {

Coordinates operator+(const Coordinates& a, const Coordinates& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Coordinates operator-(const Coordinates& a, const Coordinates& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
/// Coordinates one level up; rounds down.
Coordinates half(const Coordinates& c) { return {c.x >> 1, c.y >> 1, c.z >> 1}; }
/// Offset of neighbour j, each component in {-1, 0, 1}.
Coordinates offset_of(int j) { return {j / 9 - 1, j / 3 % 3 - 1, j % 3 - 1}; }
/// Offset of sibling s, each component in {0, 1}.
Coordinates corner_of(int s) { return {slot_x(s), slot_y(s), slot_z(s)}; }

std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i); }

class Checker {
 public:
  Checker(const HostOctree& tree, ArrayView<const std::uint64_t> points) : tree_(tree), points_(points) {}

  std::vector<std::string> run() {
    check_shapes();
    if (found_.empty()) check_ids();
    if (!found_.empty()) return std::move(found_);
    view_ = tree_.view();
    index_bricks();
    for (int d = 0; d <= tree_.depth; ++d) {
      check_keys(d);
      check_links(d);
      check_neighbours(d);
      check_corners(d);
      check_needed(d);
      check_padding(d);
      check_unknowns(d);
      check_points(d);
    }
    check_volume();
    return std::move(found_);
  }

 private:
  void note(int d, const std::string& rule) { found_.push_back("level " + std::to_string(d) + ": " + rule); }

  void expect(int d, const char* rule, bool holds) {
    if (!holds) note(d, rule);
  }

  /// Notes how many of the things [first, end) break the rule, and which one is the first.
  template <class Holds>
  void expect_all(int d, const char* rule, std::int64_t first, std::int64_t end, const Holds& holds) {
    std::int64_t broken = 0;
    std::int64_t example = 0;
    for (std::int64_t i = first; i < end; ++i)
      if (!holds(i) && broken++ == 0) example = i;
    if (broken > 0)
      note(d, std::string(rule) + "; not so for " + std::to_string(broken) + " of " + std::to_string(end - first) +
                  ", the first is " + std::to_string(example));
  }

  const HostLevel& host(int d) const { return tree_.levels[index(d)]; }

  void check_shapes() {
    if (tree_.depth < 1 || tree_.depth > kMaxDepth || tree_.levels.size() != index(tree_.depth) + 1)
      return found_.push_back("depth is in [1, 20] and there are depth + 1 levels");
    for (int d = 0; d <= tree_.depth; ++d) {
      const HostLevel& level = host(d);
      expect(d, "0 <= cell bricks <= bricks", 0 <= level.cell_bricks && level.cell_bricks <= level.bricks);
      const std::size_t bricks = index(std::max(level.bricks, 0));
      expect(d, "arrays over bricks have their shape",
             level.brick_key.size() == bricks && level.parent.size() == bricks &&
                 level.neighbours.size() == bricks * kNeighbours &&
                 level.child_brick.size() == (d == tree_.depth ? 0 : bricks * 8) && level.unknowns.size() == bricks);
      expect(d, "there is one point range per cell",
             level.point_begin.size() == index(std::max(level.cell_bricks, 0)) * 8 + 1);
    }
  }

  /// Whatever is followed later leads into an array.
  void check_ids() {
    for (int d = 0; d <= tree_.depth; ++d) {
      const HostLevel& level = host(d);
      const auto in = [](std::int32_t id, std::int64_t begin, std::int64_t end) { return begin <= id && id < end; };
      const std::int64_t parents = d == 0 ? 0 : std::int64_t{8} * host(d - 1).bricks;
      const std::int64_t children = d == tree_.depth ? 0 : host(d + 1).bricks;
      expect_all(d, "parents are nodes of the level above (-1 for the root)", 0, level.bricks,
                 [&](std::int64_t b) { return in(level.parent[index(b)], d == 0 ? -1 : 0, parents); });
      expect_all(d, "children are bricks of the level below or -1", 0, std::ssize(level.child_brick),
                 [&](std::int64_t n) { return in(level.child_brick[index(n)], -1, children); });
      expect_all(d, "neighbours are bricks of the level or -1", 0, std::int64_t{kNeighbours} * level.bricks,
                 [&](std::int64_t i) { return in(level.neighbours[index(i)], -1, level.bricks); });
    }
  }

  void index_bricks() {
    by_key_.resize(tree_.levels.size());
    for (int d = 0; d <= tree_.depth; ++d) {
      by_key_[index(d)].reserve(index(host(d).bricks));
      for (std::int32_t b = 0; b < host(d).bricks; ++b) by_key_[index(d)].emplace(host(d).brick_key[index(b)], b);
    }
  }

  /// Brick at these coordinates (in units of bricks), or -1.
  std::int32_t brick_at(int d, const Coordinates& c) const {
    if (c.x < 0 || c.y < 0 || c.z < 0) return -1;
    const auto hit = by_key_[index(d)].find(encode(c));
    return hit == by_key_[index(d)].end() ? -1 : hit->second;
  }
  bool is_cell_brick(int d, const Coordinates& c) const {
    const std::int32_t b = brick_at(d, c);
    return b >= 0 && b < host(d).cell_bricks;
  }
  static bool in_cube(int d, const Coordinates& c) {
    const std::int32_t end = 1 << d;
    return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < end && c.y < end && c.z < end;
  }
  bool is_cell(int d, const Coordinates& c) const { return in_cube(d, c) && is_cell_brick(d, half(c)); }
  Coordinates coordinates(int d, std::int64_t node) const {
    return decode(view_.levels[d].node_key(static_cast<std::int32_t>(node)));
  }
  Coordinates brick_coordinates(int d, std::int64_t b) const { return decode(host(d).brick_key[index(b)]); }

  /// True if the octree must surround the cell by cells: it has children or, on the finest level, points.
  bool is_core(int d, std::int64_t cell) const {
    if (d < tree_.depth) return view_.is_split(d, cell);
    return host(d).point_begin[index(cell) + 1] > host(d).point_begin[index(cell)];
  }

  void check_keys(int d) {
    const HostLevel& level = host(d);
    const std::uint64_t end = d == 0 ? 1 : std::uint64_t{1} << 3 * (d - 1);
    expect(d, "every brick has a key of its own", by_key_[index(d)].size() == index(level.bricks));
    expect_all(d, "keys of cell bricks ascend", 1, level.cell_bricks,
               [&](std::int64_t b) { return level.brick_key[index(b) - 1] < level.brick_key[index(b)]; });
    expect_all(d, "cell bricks lie in the cube", 0, level.cell_bricks,
               [&](std::int64_t b) { return level.brick_key[index(b)] < end; });
    if (d <= kCompleteDepth) expect(d, "the level is complete", static_cast<std::uint64_t>(level.cell_bricks) == end);
  }

  void check_links(int d) {
    const HostLevel& level = host(d);
    if (d > 0) {
      expect_all(d, "a brick is the child of its parent", 0, level.bricks,
                 [&](std::int64_t b) { return host(d - 1).child_brick[index(level.parent[index(b)])] == b; });
      expect_all(d, "a brick lies below its parent", 0, level.bricks, [&](std::int64_t b) {
        return view_.levels[d - 1].node_key(level.parent[index(b)]) == level.brick_key[index(b)];
      });
      expect_all(d, "cell bricks lie below cells", 0, level.cell_bricks,
                 [&](std::int64_t b) { return view_.levels[d - 1].is_cell(level.parent[index(b)]); });
    }
    expect_all(d, "a node is the parent of its child", 0, std::ssize(level.child_brick), [&](std::int64_t n) {
      const std::int32_t child = level.child_brick[index(n)];
      return child < 0 || host(d + 1).parent[index(child)] == n;
    });
  }

  void check_neighbours(int d) {
    const HostLevel& level = host(d);
    expect_all(d, "neighbour j is the brick at offset j, if there is one", 0, level.bricks, [&](std::int64_t b) {
      for (int j = 0; j < kNeighbours; ++j)
        if (level.neighbours[index(b * kNeighbours + j)] != brick_at(d, brick_coordinates(d, b) + offset_of(j)))
          return false;
      return true;
    });
    expect_all(d, "neighbour 26 - j of neighbour j is the brick itself", 0, level.bricks, [&](std::int64_t b) {
      for (int j = 0; j < kNeighbours; ++j) {
        const std::int64_t other = level.neighbours[index(b * kNeighbours + j)];
        if (other >= 0 && level.neighbours[index(other * kNeighbours + 26 - j)] != b) return false;
      }
      return true;
    });
  }

  void check_corners(int d) {
    const LevelView& level = view_.levels[d];
    expect_all(d, "every corner of a cell has its owner", 0, level.cells(), [&](std::int64_t cell) {
      for (int s = 0; s < 8; ++s) {
        const Coordinates o = corner_of(s);
        const std::int32_t owner = level.neighbour(static_cast<std::int32_t>(cell), o.x, o.y, o.z);
        if (owner < 0 || coordinates(d, owner) != coordinates(d, cell) + o) return false;
      }
      return true;
    });
  }

  /// Nothing exists without a reason.
  void check_needed(int d) {
    const HostLevel& level = host(d);
    expect_all(d, "a ghost brick is one step above a cell brick", level.cell_bricks, level.bricks, [&](std::int64_t b) {
      for (int s = 1; s < 8; ++s)
        if (is_cell_brick(d, brick_coordinates(d, b) - corner_of(s))) return true;
      return false;
    });
    if (d <= kCompleteDepth) return;
    expect_all(d, "a cell brick touches the neighbourhood of a cell with children or points", 0, level.cell_bricks,
               [&](std::int64_t b) {
                 for (int i = 0; i < 64; ++i) {
                   const auto cell = view_.levels[d].neighbour(static_cast<std::int32_t>(8 * b), (i >> 4) - 1,
                                                               (i >> 2 & 3) - 1, (i & 3) - 1);
                   if (view_.levels[d].is_cell(cell) && is_core(d, cell)) return true;
                 }
                 return false;
               });
  }

  void check_padding(int d) {
    const std::int64_t cells = view_.levels[d].cells();
    expect_all(d, "all 26 cells around a cell with children or points exist", 0, cells, [&](std::int64_t cell) {
      if (!is_core(d, cell)) return true;
      for (int j = 0; j < kNeighbours; ++j) {
        const Coordinates c = coordinates(d, cell) + offset_of(j);
        if (in_cube(d, c) && !is_cell(d, c)) return false;
      }
      return true;
    });
    if (d == 0) return;
    expect_all(d, "leaves around a leaf are one level coarser at most", 0, cells, [&](std::int64_t cell) {
      if (view_.is_split(d, cell)) return true;
      for (int j = 0; j < kNeighbours; ++j) {
        const Coordinates c = coordinates(d, cell) + offset_of(j);
        if (in_cube(d, c) && !is_cell(d - 1, half(c))) return false;
      }
      return true;
    });
  }

  bool is_unknown(int d, const Coordinates& corner) const {
    bool touches_cube = false;
    for (int s = 0; s < 8; ++s) {
      const Coordinates cell = corner - corner_of(s);
      if (!in_cube(d, cell)) continue;
      touches_cube = true;
      if (!is_cell(d, cell)) return false;
    }
    return touches_cube;
  }

  void check_unknowns(int d) {
    expect_all(d, "a corner is an unknown if all cells around it in the cube exist, and only then", 0,
               view_.levels[d].nodes(), [&](std::int64_t node) {
                 const bool marked = (host(d).unknowns[index(node >> 3)] >> (node & 7) & 1) != 0;
                 return marked == is_unknown(d, coordinates(d, node));
               });
  }

  void check_points(int d) {
    const std::vector<std::int32_t>& begin = host(d).point_begin;
    const auto cells = static_cast<std::int64_t>(begin.size()) - 1;
    if (begin.front() != 0 || begin.back() != points_.size || !std::is_sorted(begin.begin(), begin.end()))
      return note(d, "the cells' point ranges cut [0, n) into pieces");
    expect_all(d, "a cell's points lie in it", 0, cells, [&](std::int64_t cell) {
      for (std::int64_t i = begin[index(cell)]; i < begin[index(cell) + 1]; ++i)
        if (cell_key(points_[i], d) != view_.levels[d].node_key(static_cast<std::int32_t>(cell))) return false;
      return true;
    });
  }

  /// In units of the finest cells, of which there are at most 2^60.
  void check_volume() {
    std::uint64_t volume = 0;
    for (int d = 0; d <= tree_.depth; ++d)
      for (std::int64_t cell = 0; cell < view_.levels[d].cells(); ++cell)
        if (!view_.is_split(d, cell)) volume += std::uint64_t{1} << 3 * (tree_.depth - d);
    if (volume != std::uint64_t{1} << 3 * tree_.depth) found_.emplace_back("the volumes of the leaves sum up to 1");
  }

  const HostOctree& tree_;
  ArrayView<const std::uint64_t> points_;
  OctreeView view_;
  std::vector<std::unordered_map<std::uint64_t, std::int32_t>> by_key_;
  std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> find_violations(const HostOctree& tree, ArrayView<const std::uint64_t> point_keys) {
  return Checker(tree, point_keys).run();
}

}  // namespace pointskin::octree
