#pragma once

#include <pointskin/error.hpp>

#include <array>
#include <limits>
#include <string>
#include <utility>

#include "exec/algorithms.hpp"
#include "surface/case_table.hpp"
#include "surface/edge_vertex.hpp"
#include "surface/extract.hpp"
#include "surface/leaf_cell.hpp"
#include "surface/mark.hpp"

namespace pointskin::surface {
namespace extract {

struct HasMark {
  ArrayView<const std::uint8_t> marks;
  unsigned wanted;
  PSK_HD bool operator()(std::int64_t n) const { return (marks[n] & wanted) != 0; }
};

PSK_HD inline int count_edges(unsigned mark) {
  return static_cast<int>((mark & 1) + (mark >> 1 & 1) + (mark >> 2 & 1));
}

struct CountEdges {
  ArrayView<const std::uint8_t> marks;
  ArrayView<const std::int32_t> nodes;
  ArrayView<std::int32_t> count;
  PSK_HD void operator()(std::int64_t i) const { count[i] = count_edges(marks[nodes[i]]); }
};

struct StoreFirst {
  ArrayView<const std::int32_t> nodes, first;
  ArrayView<std::int32_t> first_vertex;
  PSK_HD void operator()(std::int64_t i) const { first_vertex[nodes[i]] = first[i]; }
};

/// Where a node of the arrays over all levels is.
struct Place {
  int level;
  std::int32_t node;
};
PSK_HD inline Place place_of(const octree::OctreeView& tree, std::int64_t index) {
  const int level = tree.level_of(index);
  return {level, static_cast<std::int32_t>(index - tree.levels[level].first_node)};
}

/// Sort key of a vertex: the corner that its edge or cell starts at, in units of the finest cells.
PSK_HD inline std::uint64_t vertex_key(const octree::OctreeView& tree, const Place& place) {
  const octree::Coordinates c = octree::decode(tree.levels[place.level].node_key(place.node));
  const int shift = tree.depth - place.level;
  return octree::encode({c.x << shift, c.y << shift, c.z << shift});
}

/// The mesh while it is made: vertices unsorted, edges' first and then the loops' centres.
struct MeshView {
  ArrayView<Vec3f> positions, normals;  // normals may be empty
  ArrayView<std::uint64_t> keys;
  ArrayView<Triangle> triangles;
};

/// Vertices on the crossed edges of one node.
struct EmitEdges {
  field::FieldView f;
  bool linear_fit;
  ArrayView<const std::uint8_t> marks;
  ArrayView<const std::int32_t> nodes, first;
  MeshView mesh;

  PSK_HD void operator()(std::int64_t i) const {
    const Place place = place_of(f.tree, nodes[i]);
    std::int32_t vertex = first[i];
    for (int axis = 0; axis < 3; ++axis)
      if ((marks[nodes[i]] >> axis & 1) != 0) emit({place.level, place.node, axis}, vertex++);
  }

  PSK_HD void emit(const EdgeOwner& owner, std::int32_t vertex) const {
    const CrossedEdge edge = crossed_edge(f.tree, owner);
    const float t = crossing_parameter(f, edge, linear_fit);
    const octree::LevelView& l = f.tree.levels[owner.level];
    const octree::Coordinates c = octree::decode(l.node_key(owner.node));
    const float width = 1.0F / static_cast<float>(1 << owner.level);
    mesh.positions[vertex] = {(static_cast<float>(c.x) + (owner.axis == 0 ? t : 0)) * width,
                              (static_cast<float>(c.y) + (owner.axis == 1 ? t : 0)) * width,
                              (static_cast<float>(c.z) + (owner.axis == 2 ? t : 0)) * width};
    mesh.keys[vertex] = vertex_key(f.tree, {owner.level, owner.node});
    if (mesh.normals.empty()) return;
    const Vec3f g0 = field::gradient_at(f, owner.level, edge.start);
    const Vec3f g1 = field::gradient_at(f, owner.level, edge.end);
    mesh.normals[vertex] = outward({g0.x + t * (g1.x - g0.x), g0.y + t * (g1.y - g0.y), g0.z + t * (g1.z - g0.z)});
  }
};

/// Vertex on an edge.
struct VertexLookup {
  octree::OctreeView tree;
  ArrayView<const std::uint8_t> marks;
  ArrayView<const std::int32_t> first_vertex;
  PSK_HD std::int32_t operator()(const EdgeOwner& owner) const {
    const std::int64_t n = tree.levels[owner.level].first_node + owner.node;
    return first_vertex[n] + count_edges(marks[n] & ((1U << owner.axis) - 1));
  }
};

/// Triangles and centre vertices of a cell.
struct CellCounts {
  std::int32_t triangles = 0, centres = 0;
};

/// A traced loop of three crossings is a triangle; a longer one is a fan around a vertex at its centre, which has no
/// diagonals that a neighbour could share.
PSK_HD inline CellCounts count_loop(int length) { return length == 3 ? CellCounts{1, 0} : CellCounts{length, 1}; }

struct CountCells {
  field::FieldView f;
  const Case* cases;
  ArrayView<const std::uint8_t> marks;
  ArrayView<const std::int32_t> cells;
  ArrayView<std::int32_t> triangles, centres;
  PSK_HD void operator()(std::int64_t i) const {
    const Place place = place_of(f.tree, cells[i]);
    const LeafCell cell(f, place.level, place.node);
    CellCounts total;
    if ((marks[cells[i]] & kTableCell) != 0) {
      total.triangles = cases[cell.corner_signs()].triangles;
    } else {
      cell.trace().for_loops([&](int, int length) {
        const CellCounts counts = count_loop(length);
        total.triangles += counts.triangles;
        total.centres += counts.centres;
      });
    }
    triangles[i] = total.triangles;
    centres[i] = total.centres;
  }
};

struct EmitCells {
  field::FieldView f;
  const Case* cases;
  VertexLookup vertex_on;
  ArrayView<const std::int32_t> cells;
  ArrayView<const std::int32_t> first_triangle, first_centre;
  std::int32_t edge_vertices;
  MeshView mesh;

  PSK_HD void operator()(std::int64_t i) const {
    const Place place = place_of(f.tree, cells[i]);
    const LeafCell cell(f, place.level, place.node);
    std::int32_t triangle = first_triangle[i];
    if ((vertex_on.marks[cells[i]] & kTableCell) != 0) {
      const Case& c = cases[cell.corner_signs()];
      for (int t = 0; t < c.triangles; ++t)
        mesh.triangles[triangle++] = {vertex_on(cell.owner_of_edge(c.edges[3 * t])),
                                      vertex_on(cell.owner_of_edge(c.edges[3 * t + 1])),
                                      vertex_on(cell.owner_of_edge(c.edges[3 * t + 2]))};
      return;
    }
    std::int32_t centre = edge_vertices + first_centre[i];
    const CellTracer tracer = cell.trace();
    tracer.for_loops([&](int start, int length) {
      const auto vertex = [&](int crossing) { return vertex_on(cell.owner_of(crossing)); };
      if (length == 3) {
        const int second = tracer.next(start);
        mesh.triangles[triangle++] = {vertex(start), vertex(second), vertex(tracer.next(second))};
        return;
      }
      Vec3f position{};
      Vec3f normal{};
      int at = start;
      for (int k = 0; k < length; ++k) {
        const std::int32_t here = vertex(at);
        at = tracer.next(at);
        mesh.triangles[triangle++] = {here, vertex(at), centre};
        add(position, mesh.positions[here]);
        if (!mesh.normals.empty()) add(normal, mesh.normals[here]);
      }
      const float share = 1.0F / static_cast<float>(length);
      mesh.positions[centre] = {position.x * share, position.y * share, position.z * share};
      if (!mesh.normals.empty()) mesh.normals[centre] = outward({-normal.x, -normal.y, -normal.z});
      mesh.keys[centre] = vertex_key(f.tree, place);
      ++centre;
    });
  }

  PSK_HD static void add(Vec3f& sum, const Vec3f& v) {
    sum.x += v.x;
    sum.y += v.y;
    sum.z += v.z;
  }
};

struct Invert {
  ArrayView<const std::int32_t> order;
  ArrayView<std::int32_t> rank;
  PSK_HD void operator()(std::int64_t i) const { rank[order[i]] = static_cast<std::int32_t>(i); }
};

struct Renumber {
  ArrayView<const std::int32_t> rank;
  ArrayView<Triangle> triangles;
  PSK_HD void operator()(std::int64_t t) const {
    std::int32_t* corner = triangles[t].data();
    for (int k = 0; k < 3; ++k) corner[k] = rank[corner[k]];
  }
};

inline void check_size(const char* what, std::int64_t count) {
  if (count > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the surface needs " + std::to_string(count) + " " + what +
                                           ", more than 32-bit ids reach; choose a smaller depth");
}

/// Exclusive scan with the total on the host.
/// @throws Error over_limit if the total does not fit into 32 bits
template <exec::Space Exec>
std::int32_t scan_counts(Exec& ex, const exec::Buffer<std::int32_t>& count, exec::Buffer<std::int32_t>& first) {
  constexpr std::int64_t kMostPerEntry = 64;  // a traced cell has at most 48 segments, so no more triangles
  if (count.size() > std::numeric_limits<std::int32_t>::max() / kMostPerEntry)
    check_size("elements", exec::sum_counts(ex, "extract.scan", count.cview()));
  first = exec::make_buffer<std::int32_t>(ex, count.size() + 1);
  exclusive_scan(ex, "extract.scan", count.cview(), first.view());
  return exec::read_element(ex, first.cview(), count.size());
}

/// Vertices in the order of their keys, triangles renumbered.
template <exec::Space Exec>
Surface sort_vertices(Exec& ex, Surface unsorted, exec::Buffer<std::uint64_t> keys, int depth) {
  const std::int64_t n = keys.size();
  exec::Buffer<std::int32_t> order = exec::iota(ex, n);
  sort_pairs(ex, "extract.sort", keys, order, 3 * (depth + 1));
  auto rank = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, "extract.renumber", n, Invert{order.cview(), rank.view()});
  for_each(ex, "extract.renumber", unsorted.triangles.size(), Renumber{rank.cview(), unsorted.triangles.view()});
  Surface sorted{exec::make_buffer<Vec3f>(ex, n), exec::make_buffer<Vec3f>(ex, unsorted.normals.size()),
                 std::move(unsorted.triangles)};
  exec::gather(ex, unsorted.positions.cview(), order.cview(), sorted.positions.view());
  exec::gather(ex, unsorted.normals.cview(), order.cview(), sorted.normals.view());
  return sorted;
}

/// The crossed edges of all levels and the vertex each node's edges start with.
struct EdgeSet {
  exec::Buffer<std::int32_t> nodes, first, first_vertex;
  std::int32_t vertices = 0;
};
template <exec::Space Exec>
EdgeSet number_edges(Exec& ex, ArrayView<const std::uint8_t> marks) {
  EdgeSet edges;
  edges.nodes = select(ex, "extract.edges", marks.size, HasMark{marks, kEdges});
  auto count = exec::make_buffer<std::int32_t>(ex, edges.nodes.size());
  for_each(ex, "extract.edges", count.size(), CountEdges{marks, edges.nodes.cview(), count.view()});
  edges.vertices = scan_counts(ex, count, edges.first);
  edges.first_vertex = exec::make_buffer<std::int32_t>(ex, marks.size);
  for_each(ex, "extract.edges", count.size(),
           StoreFirst{edges.nodes.cview(), edges.first.cview(), edges.first_vertex.view()});
  return edges;
}

}  // namespace extract

template <exec::Space Exec>
Surface extract_surface(Exec& ex, const field::FieldView& f, const ExtractOptions& options) {
  using namespace extract;
  check_size("nodes", f.tree.nodes);
  auto marks = exec::make_buffer<std::uint8_t>(ex, f.tree.nodes);
  for_each(ex, "extract.mark", f.tree.nodes / 8, MarkBrick{f, marks.view()});
  const EdgeSet edges = number_edges(ex, marks.cview());

  const exec::Buffer<std::int32_t> cells = select(ex, "extract.cells", f.tree.nodes, HasMark{marks.cview(), kCells});
  const std::array<Case, 256> table = make_case_table();
  auto cases = exec::make_buffer<Case>(ex, 256);
  copy_to_device(ex, table.data(), cases.view());
  auto triangle_count = exec::make_buffer<std::int32_t>(ex, cells.size());
  auto centre_count = exec::make_buffer<std::int32_t>(ex, cells.size());
  for_each(ex, "extract.cells", cells.size(),
           CountCells{f, cases.data(), marks.cview(), cells.cview(), triangle_count.view(), centre_count.view()});
  exec::Buffer<std::int32_t> first_triangle;
  exec::Buffer<std::int32_t> first_centre;
  const std::int32_t triangles = scan_counts(ex, triangle_count, first_triangle);
  const std::int64_t vertices = std::int64_t{edges.vertices} + scan_counts(ex, centre_count, first_centre);
  check_size("vertices", vertices);

  Surface surface{exec::make_buffer<Vec3f>(ex, vertices), exec::make_buffer<Vec3f>(ex, options.normals ? vertices : 0),
                  exec::make_buffer<Triangle>(ex, triangles)};
  auto keys = exec::make_buffer<std::uint64_t>(ex, vertices);
  const MeshView mesh{surface.positions.view(), surface.normals.view(), keys.view(), surface.triangles.view()};
  for_each(ex, "extract.vertices", edges.nodes.size(),
           EmitEdges{f, options.linear_fit, marks.cview(), edges.nodes.cview(), edges.first.cview(), mesh});
  for_each(ex, "extract.triangles", cells.size(),
           EmitCells{f,
                     cases.data(),
                     {f.tree, marks.cview(), edges.first_vertex.cview()},
                     cells.cview(),
                     first_triangle.cview(),
                     first_centre.cview(),
                     edges.vertices,
                     mesh});
  return sort_vertices(ex, std::move(surface), std::move(keys), f.tree.depth);
}

}  // namespace pointskin::surface
