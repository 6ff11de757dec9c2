#include "surface/extract.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "core/bits.hpp"
#include "exec/this_space.hpp"
#include "octree/placed.hpp"
#include "surface/case_table.hpp"
#include "surface/check_size.hpp"
#include "surface/edge_vertex.hpp"
#include "surface/inside_ends.hpp"
#include "surface/leaf_cell.hpp"
#include "surface/mark.hpp"

namespace pointskin::surface {
namespace {

using namespace extract;

struct IsTraced {
  ArrayView<const std::uint8_t> marks;
  PSK_HD bool operator()(std::int64_t n) const { return (marks[n] & kTracedCell) != 0; }
};

/// The marks of a brick's 8 nodes as one number, the first node in the lowest byte.
PSK_HD std::uint64_t brick_marks(ArrayView<const std::uint8_t> marks, std::int64_t brick) {
  std::uint64_t all = 0;
  memcpy(&all, marks.data + 8 * brick, sizeof all);
  return all;
}

/// Two counts that are scanned together.
PSK_HD constexpr std::uint64_t pack(std::uint64_t low, std::uint64_t high) { return high << 32 | low; }
PSK_HD constexpr std::int32_t low_count(std::uint64_t packed) { return static_cast<std::int32_t>(packed & 0xffffffff); }
PSK_HD constexpr std::int32_t high_count(std::uint64_t packed) { return static_cast<std::int32_t>(packed >> 32); }

constexpr std::uint64_t kEveryByte = 0x0101010101010101;

/// Crossed edges and table triangles of the marks of up to 8 nodes.
PSK_HD std::uint64_t count_marked(std::uint64_t marks) {
  const std::uint64_t triangles = (marks >> kTrianglesShift & 7 * kEveryByte) * kEveryByte >> 56;  // sum of the bytes
  return pack(static_cast<std::uint64_t>(count_bits(marks & kEdges * kEveryByte)), triangles);
}

struct CountBrick {
  ArrayView<const std::uint8_t> marks;
  ArrayView<std::uint64_t> counts;
  PSK_HD void operator()(std::int64_t brick) const { counts[brick] = count_marked(brick_marks(marks, brick)); }
};

/// Where every node's vertices and triangles start.
struct Numbering {
  ArrayView<const std::uint8_t> marks;
  ArrayView<const std::uint64_t> first;  // (bricks + 1) packed: edge vertices and table triangles before each brick

  /// Packed: before node n.
  PSK_HD std::uint64_t before(std::int64_t n) const {
    const std::uint64_t earlier = (std::uint64_t{1} << 8 * (n & 7)) - 1;
    return first[n >> 3] + count_marked(brick_marks(marks, n >> 3) & earlier);
  }

  /// Vertex on a crossed edge of node n.
  PSK_HD std::int32_t vertex(std::int64_t n, int axis) const {
    const std::uint64_t earlier = (std::uint64_t{1} << (8 * (n & 7) + axis)) - 1;
    const std::uint64_t edges = brick_marks(marks, n >> 3) & kEdges * kEveryByte & earlier;
    return low_count(first[n >> 3]) + count_bits(edges);
  }
};

/// Where a node of the arrays over all levels is.
struct Place {
  int level;
  std::int32_t node;
};
PSK_HD Place place_of(const octree::OctreeView& tree, std::int64_t index) {
  const int level = tree.level_of(index);
  return {level, static_cast<std::int32_t>(index - tree.levels[level].first_node)};
}

/// Sort key of a vertex: the corner that its edge or cell starts at, in units of the finest cells.
PSK_HD std::uint64_t vertex_key(const octree::OctreeView& tree, const Place& place) {
  const octree::Coordinates c = octree::decode(tree.levels[place.level].node_key(place.node));
  const int shift = tree.depth - place.level;
  return octree::encode({c.x << shift, c.y << shift, c.z << shift});
}

/// Notes which cell the triangles of the table lie in, once ListItems has noted their nodes.
struct PlaceFromTable {
  octree::OctreeView tree;
  ArrayView<const Triangle> items;
  ArrayView<std::uint64_t> cells;
  ArrayView<std::uint8_t> segments;
  PSK_HD void operator()(std::int64_t t) const {
    const Place place = place_of(tree, items[t][0]);
    cells[t] = vertex_key(tree, place);
    segments[t] = static_cast<std::uint8_t>(place.level);
  }
};

/// The same for those of cells next to finer ones, which follow.
struct PlaceTraced {
  octree::OctreeView tree;
  std::int32_t table_triangles;
  ArrayView<const std::int32_t> traced;
  ArrayView<const std::uint64_t> first_traced;  // packed
  ArrayView<std::uint64_t> cells;
  ArrayView<std::uint8_t> segments;
  PSK_HD void operator()(std::int64_t i) const {
    const Place place = place_of(tree, traced[i]);
    const std::int32_t end = table_triangles + low_count(first_traced[i + 1]);
    for (std::int32_t t = table_triangles + low_count(first_traced[i]); t < end; ++t) {
      cells[t] = vertex_key(tree, place);
      segments[t] = static_cast<std::uint8_t>(SurfacePlaces::kTraced + place.level);
    }
  }
};

/// The mesh while it is made: vertices unsorted, edges' first and then the loops' centres.
struct MeshView {
  ArrayView<Vec3f> positions, normals;  // normals may be empty
  ArrayView<std::uint64_t> keys;
  ArrayView<Triangle> triangles;
};

/// Notes for every edge vertex where it lies, and for every table triangle what it is: so that the work that follows is
/// one thread an item, however few nodes meet the surface.
struct ListItems {
  Numbering numbering;
  ArrayView<const std::uint8_t> signs;
  MeshView mesh;

  PSK_HD void operator()(std::int64_t n) const {
    const unsigned mark = numbering.marks[n];
    if ((mark & (kEdges | kTriangles)) == 0) return;
    const std::uint64_t before = numbering.before(n);
    std::int32_t vertex = low_count(before);
    for (int axis = 0; axis < 3; ++axis)
      if ((mark >> axis & 1) != 0)
        mesh.keys[vertex++] = static_cast<std::uint64_t>(n) << 2 | static_cast<unsigned>(axis);
    const int triangles = static_cast<int>((mark & kTriangles) >> kTrianglesShift);
    const std::int32_t first = high_count(before);
    for (int t = 0; t < triangles; ++t) mesh.triangles[first + t] = {static_cast<std::int32_t>(n), signs[n], t};
  }
};

/// A vertex on an edge that ListItems has noted.
struct EmitVertex {
  field::FieldView f;
  float curvature;
  MeshView mesh;

  PSK_HD void operator()(std::int64_t vertex) const {
    const std::uint64_t item = mesh.keys[vertex];
    const Place place = place_of(f.tree, static_cast<std::int64_t>(item >> 2));
    emit({place.level, place.node, static_cast<int>(item & 3)}, static_cast<std::int32_t>(vertex));
  }

  PSK_HD void emit(const EdgeOwner& owner, std::int32_t vertex) const {
    const CrossedEdge edge = crossed_edge(f.tree, owner);
    const float t = crossing_parameter(f, edge, curvature);
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
    const Vec3f normal = outward({g0.x + t * (g1.x - g0.x), g0.y + t * (g1.y - g0.y), g0.z + t * (g1.z - g0.z)});
    mesh.normals[vertex] = normal == Vec3f{} ? outward_along(f, owner, c) : normal;
  }
};

/// Triangles and centre vertices of a cell.
struct CellCounts {
  std::int32_t triangles = 0, centres = 0;
};

/// A traced loop of three crossings is a triangle; a longer one is a fan around a vertex at its centre, which has no
/// diagonals that a neighbour could share.
PSK_HD CellCounts count_loop(int length) { return length == 3 ? CellCounts{1, 0} : CellCounts{length, 1}; }

/// Packed triangles and centres of the traced cells.
struct CountTraced {
  field::FieldView f;
  ArrayView<const std::int32_t> cells;
  ArrayView<std::uint64_t> counts;
  PSK_HD void operator()(std::int64_t i) const {
    const Place place = place_of(f.tree, cells[i]);
    std::uint64_t total = 0;
    LeafCell(f, place.level, place.node).trace().for_loops([&](int, int length) {
      const CellCounts counted = count_loop(length);
      total += pack(static_cast<std::uint64_t>(counted.triangles), static_cast<std::uint64_t>(counted.centres));
    });
    counts[i] = total;
  }
};

/// All triangles, and the centres of loops. Needs the vertices on edges.
struct EmitTriangles {
  field::FieldView f;
  const Case* cases;
  Numbering numbering;
  MeshView mesh;
  std::int32_t edge_vertices, table_triangles;
  ArrayView<const std::int32_t> traced;
  ArrayView<const std::uint64_t> first_traced;  // packed, as counted

  /// Vertex on an edge.
  [[nodiscard]] PSK_HD std::int32_t vertex_on(const EdgeOwner& owner) const {
    return numbering.vertex(f.tree.levels[owner.level].first_node + owner.node, owner.axis);
  }

  /// A triangle of a leaf without finer neighbours that ListItems has noted.
  PSK_HD void emit_from_table(std::int64_t t) const {
    const std::int32_t* item = mesh.triangles[t].data();
    const Place place = place_of(f.tree, item[0]);
    const LeafCell cell(f, place.level, place.node);
    const Case& c = cases[item[1]];
    if (c.is_quadrilateral()) {
      mesh.triangles[t] = half_of(cell, place, c, item[2]);
      return;
    }
    const std::uint8_t* edges = c.edges + 3 * item[2];
    mesh.triangles[t] = {vertex_on(cell.owner_of_edge(edges[0])), vertex_on(cell.owner_of_edge(edges[1])),
                         vertex_on(cell.owner_of_edge(edges[2]))};
  }

  /// One of the two triangles of a quadrilateral, cut along the diagonal whose middle is nearer to the surface.
  [[nodiscard]] PSK_HD Triangle half_of(const LeafCell& cell, const Place& place, const Case& c, int half) const {
    const std::int32_t a = vertex_on(cell.owner_of_edge(c.edges[3]));
    const std::int32_t b = vertex_on(cell.owner_of_edge(c.edges[0]));
    const std::int32_t d = vertex_on(cell.owner_of_edge(c.edges[1]));
    const std::int32_t e = vertex_on(cell.owner_of_edge(c.edges[2]));
    if (distance_between(place, a, d) < distance_between(place, b, e))
      return half == 0 ? Triangle{a, b, d} : Triangle{a, d, e};
    return half == 0 ? Triangle{b, d, e} : Triangle{a, b, e};
  }

  /// How far the field is from the isovalue in the middle of two vertices of a cell.
  [[nodiscard]] PSK_HD float distance_between(const Place& place, std::int32_t a, std::int32_t b) const {
    const Vec3f p = mesh.positions[a];
    const Vec3f q = mesh.positions[b];
    const Vec3f middle{0.5F * (p.x + q.x), 0.5F * (p.y + q.y), 0.5F * (p.z + q.z)};
    const octree::LevelView& l = f.tree.levels[place.level];
    const Vec3f local = octree::local_in_cell(middle, octree::decode(l.node_key(place.node)), l.depth);
    const float off = octree::interpolated(l, f.values + l.first_node, place.node, local) - f.isovalue;
    return off < 0 ? -off : off;
  }

  /// The triangles and centres of a traced cell.
  PSK_HD void emit_traced(std::int64_t i) const {
    const Place place = place_of(f.tree, traced[i]);
    const LeafCell cell(f, place.level, place.node);
    std::int32_t triangle = table_triangles + low_count(first_traced[i]);
    std::int32_t centre = edge_vertices + high_count(first_traced[i]);
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
      int at = tracer.next(start);
      const std::int32_t first_vertex = vertex(start);
      std::int32_t here = first_vertex;
      for (int k = 0; k < length; ++k) {
        const std::int32_t there = k + 1 < length ? vertex(at) : first_vertex;
        at = tracer.next(at);
        mesh.triangles[triangle++] = {here, there, centre};
        position += mesh.positions[here];
        if (!mesh.normals.empty()) normal += mesh.normals[here];
        here = there;
      }
      const float share = 1.0F / static_cast<float>(length);
      mesh.positions[centre] = position * share;
      if (!mesh.normals.empty()) {
        const Vec3f mean = outward(-normal);
        mesh.normals[centre] = mean == Vec3f{} ? mesh.normals[first_vertex] : mean;  // where they cancel, any of them
      }
      mesh.keys[centre] = vertex_key(f.tree, place);
      ++centre;
    });
  }
};

struct EmitFromTable {
  EmitTriangles emit;
  PSK_HD void operator()(std::int64_t t) const { emit.emit_from_table(t); }
};
struct EmitTraced {
  EmitTriangles emit;
  PSK_HD void operator()(std::int64_t i) const { emit.emit_traced(i); }
};

/// Both side by side: the traced cells, which take long, come first, and are spread.
struct EmitTogether {
  EmitTriangles emit;
  int lanes;  // indices for each of the traced cells

  [[nodiscard]] PSK_HD std::int64_t spread() const { return lanes * emit.traced.size; }
  PSK_HD void operator()(std::int64_t index) const {
    if (index >= spread())
      emit.emit_from_table(index - spread());
    else if (index % lanes == 0)
      emit.emit_traced(index / lanes);
  }
};

template <exec::Space Exec>
void emit_triangles(Exec& ex, const EmitTriangles& emit) {
  constexpr const char* kLabel = "extract.triangles";
  if constexpr (Exec::kManyThreads) {
    const EmitTogether together{emit, lanes_apart(ex, emit.traced.size)};
    for_each(ex, kLabel, together.spread() + emit.table_triangles, together);
  } else {
    for_each(ex, kLabel, emit.table_triangles, EmitFromTable{emit});
    for_each_apart(ex, kLabel, emit.traced.size, EmitTraced{emit});
  }
}

struct Invert {
  ArrayView<const std::int32_t> order;
  ArrayView<std::int32_t> rank;
  PSK_HD void operator()(std::int64_t i) const { rank[order[i]] = static_cast<std::int32_t>(i); }
};

struct TakeVertex {
  ArrayView<const std::int32_t> order;
  ArrayView<const Vec3f> positions, normals;
  ArrayView<Vec3f> taken_positions, taken_normals;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t from = order[i];
    taken_positions[i] = positions[from];
    if (!normals.empty()) taken_normals[i] = normals[from];
  }
};

struct Renumber {
  ArrayView<const std::int32_t> rank;
  ArrayView<Triangle> triangles;
  PSK_HD void operator()(std::int64_t t) const {
    std::int32_t* corner = triangles[t].data();
    for (int k = 0; k < 3; ++k) corner[k] = rank[corner[k]];
  }
};

struct LowCount {
  ArrayView<const std::uint64_t> packed;
  PSK_HD std::int64_t operator()(std::int64_t i) const { return low_count(packed[i]); }
};
struct AddCounts {
  PSK_HD std::int64_t operator()(std::int64_t a, std::int64_t b) const { return a + b; }
};

/// Exclusive scan of packed counts.
/// @param first           shape (counts + 1), receives the scan and the total
/// @param most_per_entry  bound of the low counts, which must not spill into the high ones
/// @throws Error over_limit if a total does not fit into 32 bits
template <exec::Space Exec>
void scan_counts(Exec& ex, const exec::Buffer<std::uint64_t>& counts, ArrayView<std::uint64_t> first,
                 std::int64_t most_per_entry) {
  if (counts.size() > std::numeric_limits<std::int32_t>::max() / most_per_entry)
    check_size("elements",
               exec::reduce<std::int64_t>(ex, "extract.scan", counts.size(), LowCount{counts.cview()}, AddCounts{}));
  exclusive_scan(ex, "extract.scan", counts.cview(), first);
}

/// What the sizes of the mesh follow from, beside each other, so that it is read at once.
struct Totals {
  std::uint64_t table, traced;  ///< packed
  std::uint64_t lone_corners;
};
struct CollectTotals {
  ArrayView<const std::uint64_t> first, first_traced;  // the second may be empty
  ArrayView<const std::uint64_t> lone_corners;
  ArrayView<Totals> out;
  PSK_HD void operator()(std::int64_t /*i*/) const {
    out[0] = {first[first.size - 1], first_traced.empty() ? 0 : first_traced[first_traced.size - 1], lone_corners[0]};
  }
};

/// Vertices in the order of their keys, triangles renumbered.
/// @param places  receives the keys, unless it is null
template <exec::Space Exec>
Surface sort_vertices(Exec& ex, Surface unsorted, exec::Buffer<std::uint64_t> keys, int depth, SurfacePlaces* places) {
  const std::int64_t n = keys.size();
  exec::Buffer<std::int32_t> order = exec::iota(ex, n);
  sort_pairs(ex, "extract.sort", keys, order, 3 * (depth + 1));
  if (places != nullptr) places->keys = std::move(keys);
  keys.reset();
  auto rank = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, "extract.renumber", n, Invert{order.cview(), rank.view()});
  for_each(ex, "extract.renumber", unsorted.triangles.size(), Renumber{rank.cview(), unsorted.triangles.view()});
  rank.reset();
  Surface sorted{exec::make_buffer<Vec3f>(ex, n), exec::make_buffer<Vec3f>(ex, unsorted.normals.size()),
                 std::move(unsorted.triangles)};
  for_each(ex, "extract.take", n,
           TakeVertex{order.cview(), unsorted.positions.cview(), unsorted.normals.cview(), sorted.positions.view(),
                      sorted.normals.view()});
  return sorted;
}

TriangleCounts count_triangles(const std::array<Case, 256>& cases) {
  TriangleCounts counts;
  std::transform(cases.begin(), cases.end(), counts.of_case, [](const Case& c) { return c.triangles; });
  return counts;
}

}  // namespace

template <exec::Space Exec>
Surface extract_surface(Exec& ex, const field::FieldView& f, const ExtractOptions& options) {
  constexpr std::int64_t kMostEdgesPerBrick = 24;
  constexpr std::int64_t kMostTrianglesPerCell = 64;  // a traced cell has at most 48 segments, so no more triangles
  static const std::array<Case, 256> kCases = make_case_table();
  check_size("nodes", f.tree.nodes);
  auto cases = exec::make_buffer<Case>(ex, 256);
  copy_constant_to_device(ex, kCases.data(), cases.view());
  const std::int64_t bricks = f.tree.nodes / 8;
  auto placed = octree::placed_on_levels(ex, f.tree, f.tree.depth);
  auto marks = exec::make_buffer<std::uint8_t>(ex, f.tree.nodes);
  auto signs = exec::make_buffer<std::uint8_t>(ex, f.tree.nodes);
  auto lone_corners = exec::make_buffer<std::uint64_t>(ex, 1);
  exec::fill(ex, lone_corners.view(), std::uint64_t{0});
  const Marker marker{f, count_triangles(kCases), marks.view(), signs.view(), lone_corners.data(), options.counted};
  if constexpr (Exec::kManyThreads)
    for_each(ex, "extract.mark", f.tree.nodes, MarkNode{marker});
  else
    for_each(ex, "extract.mark", bricks, MarkBrick{marker});

  exec::Buffer<std::uint64_t> first;
  const auto count_items = [&] {
    auto counts = exec::make_buffer<std::uint64_t>(ex, bricks);
    for_each(ex, "extract.count", counts.size(), CountBrick{marks.cview(), counts.view()});
    first = exec::make_buffer<std::uint64_t>(ex, bricks + 1);
    scan_counts(ex, counts, first.view(), kMostEdgesPerBrick);
  };
  exec::Buffer<std::int32_t> traced;
  if (f.tree.finest().first_node > 0)  // there are coarser leaves
    traced = select_meanwhile(ex, "extract.traced", f.tree.nodes, IsTraced{marks.cview()}, count_items);
  else
    count_items();
  placed.end();
  auto traced_counts = exec::make_buffer<std::uint64_t>(ex, traced.size());
  for_each_apart(ex, "extract.traced", traced.size(), CountTraced{f, traced.cview(), traced_counts.view()});
  auto first_traced = exec::make_buffer<std::uint64_t>(ex, traced.empty() ? 0 : traced.size() + 1);
  if (!traced.empty()) scan_counts(ex, traced_counts, first_traced.view(), kMostTrianglesPerCell);
  auto collected = exec::make_buffer<Totals>(ex, 1);
  for_each(ex, "extract.scan", 1,
           CollectTotals{first.cview(), first_traced.cview(), lone_corners.cview(), collected.view()});
  const Totals totals = exec::read_element(ex, collected.cview(), 0);
  const std::int64_t vertices = std::int64_t{low_count(totals.table)} + high_count(totals.traced);
  const std::int64_t triangles = std::int64_t{high_count(totals.table)} + low_count(totals.traced);
  check_size("vertices", vertices);
  check_size("triangles", triangles);

  Surface surface{exec::make_buffer<Vec3f>(ex, vertices), exec::make_buffer<Vec3f>(ex, options.normals ? vertices : 0),
                  exec::make_buffer<Triangle>(ex, triangles)};
  auto keys = exec::make_buffer<std::uint64_t>(ex, vertices);
  const MeshView mesh{surface.positions.view(), surface.normals.view(), keys.view(), surface.triangles.view()};
  const Numbering numbering{marks.cview(), first.cview()};
  {
    const auto placed_on_levels = octree::placed_on_levels(ex, f.tree, f.tree.depth);
    for_each(ex, "extract.list", f.tree.nodes, ListItems{numbering, signs.cview(), mesh});
  }
  signs.reset();
  if (options.places != nullptr) {
    options.places->cells = exec::make_buffer<std::uint64_t>(ex, triangles);
    options.places->segments = exec::make_buffer<std::uint8_t>(ex, triangles);
    const ArrayView<std::uint64_t> cells = options.places->cells.view();
    const ArrayView<std::uint8_t> segments = options.places->segments.view();
    const std::int32_t from_table = high_count(totals.table);
    for_each(ex, "extract.list", from_table,
             PlaceFromTable{f.tree, surface.triangles.cview().part(0, from_table), cells, segments});
    for_each(ex, "extract.list", traced.size(),
             PlaceTraced{f.tree, from_table, traced.cview(), first_traced.cview(), cells, segments});
  }
  const std::int32_t on_edges = low_count(totals.table);
  exec::Buffer<Vec3f> inside_ends;
  if (options.move_vertices) {
    inside_ends = exec::make_buffer<Vec3f>(ex, on_edges);
    for_each(ex, "extract.ends", on_edges, InsideEnds{f, keys.cview(), inside_ends.view()});
  }
  for_each(ex, "extract.vertices", on_edges, EmitVertex{f, options.curvature, mesh});
  if (options.move_vertices) options.move_vertices(surface.positions.view().part(0, on_edges), inside_ends.cview());
  inside_ends.reset();
  emit_triangles(ex, EmitTriangles{f, cases.data(), numbering, mesh, on_edges, high_count(totals.table), traced.cview(),
                                   first_traced.cview()});
  marks.reset();
  first.reset();
  surface = sort_vertices(ex, std::move(surface), std::move(keys), f.tree.depth, options.places);
  surface.lone_corners = static_cast<std::int64_t>(totals.lone_corners);
  return surface;
}

PSK_INSTANTIATE(extract_surface);

}  // namespace pointskin::surface
