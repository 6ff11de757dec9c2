#include "reconstruct/memory_model.hpp"

#include <algorithm>

#include "field/attributes.hpp"
#include "octree/brick_sets.hpp"
#include "octree/keys.hpp"

namespace pointskin::detail {
namespace {

// Bytes a point.
constexpr std::int64_t kUploaded = 24;             // position, normal
constexpr std::int64_t kSorting = kUploaded + 44;  // position in the cube, hash; key, index, and both again
constexpr std::int64_t kSelected = 4;              // index of a point that is used, where some are not
constexpr std::int64_t kSorted = 24;               // position in the cube, normal
constexpr std::int64_t kKey = 8;
constexpr std::int64_t kWeighed = kSorted + 8;      // area, splat depth
constexpr std::int64_t kCollapsed = kWeighed - 12;  // no normal any more
constexpr std::int64_t kTrust = 4;
constexpr std::int64_t kArea = 4;       // once more: on its own side; with an envelope
constexpr std::int64_t kSpacing = 16;   // trimming: key, and both again
constexpr std::int64_t kShare = 4;      // of an attribute that is averaged; of a weight
constexpr std::int64_t kLabelled = 20;  // searches among points of which some lack a label
constexpr std::int64_t kUnit = 12;      // position in the cube

// Bytes a brick.
constexpr std::int64_t kBrick = 121;             // key, parent, 27 neighbours, unknowns
constexpr std::int64_t kChildren = 32;           // of bricks above the finest level
constexpr std::int64_t kPointRanges = 32;        // of cell bricks
constexpr std::int64_t kNodeValue = 32;          // one float a node
constexpr std::int64_t kResolution = 2;          // whether its cells count, their unknowns
constexpr std::int64_t kScreening = 5;           // place of the collapsed samples, corners that they touch
constexpr std::int64_t kCollapsedSamples = 128;  // of occupied bricks
constexpr std::int64_t kFree = 1;                // unknowns that are solved for, where some are held
constexpr std::int64_t kWeightedValues = 128;    // of cell bricks: two doubles a cell
constexpr std::int64_t kHats = 256;              // of cell bricks: eight floats a cell
constexpr std::int64_t kMarks = 16;              // two bytes a node
constexpr std::int64_t kNumbering = 8;           // first vertex and triangle

// Bytes an occupied cell: its key, its first point, and eight candidate bricks, sorted.
constexpr std::int64_t kCandidates = 8 + 4 + 2 * 64;

// Bytes a vertex and a triangle.
constexpr std::int64_t kPosition = 12;  // as large as a normal
constexpr std::int64_t kTriangle = 12;
constexpr std::int64_t kVertexKey = 8;
constexpr std::int64_t kOrder = 4;
constexpr std::int64_t kSides = 5;       // trimming: spacing, whether it stays
constexpr std::int64_t kPieces = 4 + 8;  // trimming: piece, its area

/// Nodes to ten vertices: 76 to 90 for scans and common shapes, whose nodes are a band of cells around the surface; 40
/// where the surface fills the cube like a sponge. Meshes have two triangles a vertex.
constexpr std::int64_t kNodesPerTenVertices = 75;
constexpr std::int64_t kTrianglesPerVertex = 2;

/// Vertices a sample where samples are sparse: cells that they do not resolve have none. Complete levels have some
/// anyway.
constexpr std::int64_t kVerticesPerPoint = 10;
constexpr std::int64_t kCompleteVertices = 5000;

/// Sums over the levels.
struct Model {
  const RunSize& size;
  const Options& options;
  std::int64_t points = size.points;
  const AttributeBytes& attributes = size.attributes;
  std::int64_t bricks = 0, cell_bricks = 0;
  std::int64_t occupied_bricks = 1;  // the root's
  std::int64_t most_bricks = 0;      // of one level
  std::int64_t counted_bricks = 0;   // of the levels that count samples
  std::int64_t cycled_bricks = 0;    // of the complete levels, as often as the cycles have arrays of them

  Model(const RunSize& of, const Options& with) : size(of), options(with) {
    for (int d = 0; d <= depth(); ++d) {
      const octree::BrickCounts& own = level(d);
      bricks += own.bricks;
      cell_bricks += own.cell_bricks;
      if (d < depth()) occupied_bricks += own.occupied_cells;
      most_bricks = std::max(most_bricks, own.bricks);
      if (d <= counted_depth()) counted_bricks += own.bricks;
      if (d <= octree::kCompleteDepth)
        cycled_bricks += (d == std::min(depth(), octree::kCompleteDepth) ? 5 : 6) * own.bricks;
    }
  }

  [[nodiscard]] int depth() const { return static_cast<int>(size.levels.size()) - 1; }
  [[nodiscard]] int counted_depth() const { return std::max(0, depth() - 2); }
  [[nodiscard]] const octree::BrickCounts& level(int d) const { return size.levels[static_cast<std::size_t>(d)]; }

  [[nodiscard]] std::int64_t tree() const {
    return kBrick * bricks + kChildren * (bricks - level(depth()).bricks) + kPointRanges * cell_bricks;
  }
  [[nodiscard]] bool is_distance() const { return options.field == FieldKind::distance; }
  [[nodiscard]] bool has_envelope() const { return options.envelope != nullptr; }
  [[nodiscard]] bool trims() const { return options.trim != 0; }
  [[nodiscard]] bool picks_pieces() const { return options.largest || options.min_component > 0; }
  [[nodiscard]] std::int64_t kept_counts() const { return kNodeValue * counted_bricks; }
  [[nodiscard]] std::int64_t vertices() const {
    // Of a complete finest level, a surface meets fewer cells than of a band around it.
    const std::int64_t near = depth() > octree::kCompleteDepth ? bricks : 3 * bricks / 4;
    if (is_distance()) return 80 * near / kNodesPerTenVertices;
    return std::min(80 * bricks / kNodesPerTenVertices, kVerticesPerPoint * points + kCompleteVertices);
  }
  [[nodiscard]] std::int64_t vertex() const { return options.normals || trims() ? 2 * kPosition : kPosition; }
  [[nodiscard]] std::int64_t mesh() const { return (vertex() + kTrianglesPerVertex * kTriangle) * vertices(); }

  /// Attributes of the samples, and what they count.
  [[nodiscard]] std::int64_t kept_attributes() const {
    const std::int64_t weight = attributes.count > 0 && options.confidence ? kShare : 0;
    return (attributes.sorted + weight) * points;
  }

  /// What is there from the tree to the mesh.
  [[nodiscard]] std::int64_t kept() const { return tree() + kResolution * bricks + kept_attributes(); }
  /// Positions of the samples, for their attributes.
  [[nodiscard]] std::int64_t kept_positions() const { return attributes.count > 0 ? kUnit * points : 0; }
  /// The solved field.
  [[nodiscard]] std::int64_t field() const { return kept() + kept_positions() + kept_counts() + kNodeValue * bricks; }

  /// The sort, or, with many attributes, these in both orders.
  [[nodiscard]] std::int64_t sort() const {
    const std::int64_t strays =
        size.strays > 0 ? (kUploaded + attributes.uploaded) * size.strays + kSelected * points : 0;
    const std::int64_t gathered = kUploaded + kSorted + kKey + kOrder;
    return strays + (attributes.uploaded + std::max(kSorting, gathered + attributes.sorted)) * points;
  }

  /// Keys of all cell bricks, and what finding them takes: bitmaps and the bits before every word, or eight candidates
  /// an occupied cell, sorted.
  [[nodiscard]] std::int64_t find_bricks() const {
    const int last = octree::build::deepest_bitmap(points, depth());
    std::int64_t words = 0;
    for (int d = octree::kCompleteDepth + 1; d <= last; ++d) words += octree::build::bitmap_words(d);
    std::int64_t bytes = 8 * words;
    if (last < depth()) bytes = std::max(bytes, kCandidates * level(depth()).occupied_cells);
    return (kSorted + kKey) * points + kept_attributes() + bytes + 8 * cell_bricks;
  }

  [[nodiscard]] std::int64_t build_tree() const { return (kSorted + kKey) * points + kept_attributes() + tree(); }

  [[nodiscard]] std::int64_t density() const {
    const std::int64_t counts = kNodeValue * counted_bricks;
    const std::int64_t hats = kHats * level(counted_depth()).cell_bricks;
    constexpr std::int64_t kComponents = 4;  // of the sums of normals
    return (kWeighed + kArea) * points + kept() + counts + kComponents * (counts + hats);
  }

  /// Planes for the signed distance, and their weights, which with attributes are counted there.
  [[nodiscard]] std::int64_t planes() const {
    const std::int64_t weight = options.confidence && attributes.count == 0 ? kShare : 0;
    return is_distance() ? (kUnit + weight) * points : 0;
  }
  /// The solved field and the distances.
  [[nodiscard]] std::int64_t distance() const {
    if (!is_distance()) return 0;
    return kCollapsed * points + planes() + kept() + kept_counts() + 2 * kNodeValue * bricks;
  }

  /// The vector field of the finest level, the divergence of all and, once more, of the coarser ones, as if there were
  /// samples for them.
  [[nodiscard]] std::int64_t splat() const {
    const bool trusts = options.screening > 0 && !options.fixed_screening;
    return (kWeighed + (trusts ? kTrust : 0)) * points + planes() + kept() + kept_counts() +
           kNodeValue * (2 * bricks + 2 * level(depth()).bricks);
  }

  /// Divergence and solution of all levels; the other solution of one level, or the cycles' arrays.
  [[nodiscard]] std::int64_t solve() const {
    const std::int64_t screening =
        options.screening > 0 ? kScreening * bricks + kCollapsedSamples * occupied_bricks : 0;
    const std::int64_t free = options.boundary == Boundary::dirichlet || has_envelope() ? kFree * bricks : 0;
    return kCollapsed * points + planes() + kept() + kept_counts() + screening + free +
           kNodeValue * (2 * bricks + std::max(most_bricks, cycled_bricks));
  }

  [[nodiscard]] std::int64_t isovalue() const {
    const std::int64_t inside = has_envelope() ? kArea * points : 0;
    return kCollapsed * points + inside + planes() + kept() + kept_counts() + kNodeValue * bricks +
           kWeightedValues * level(depth()).cell_bricks;
  }

  /// The largest of: marks with their counts and sums; the mesh as it is made; the mesh as its vertices are sorted.
  [[nodiscard]] std::int64_t extract() const {
    const std::int64_t mark = (kMarks + 2 * kNumbering) * bricks;
    const std::int64_t ends = has_envelope() ? kPosition : 0;  // of the edges
    const std::int64_t make = mesh() + (kVertexKey + ends) * vertices() + (kMarks + kNumbering) * bricks;
    const std::int64_t sort = mesh() + (std::max(2 * kVertexKey + kOrder, vertex()) + kOrder) * vertices();
    return field() + std::max({mark, make, sort});
  }

  /// Spacing at the samples.
  [[nodiscard]] std::int64_t trim_limit() const {
    return trims() ? (kWeighed + kSpacing) * points + planes() + kept() + kept_counts() : 0;
  }

  /// The larger of: pieces and their areas; the triangles that stay, as if all did.
  [[nodiscard]] std::int64_t trim() const {
    if (!trims()) return 0;
    const std::int64_t stay = 2 * kOrder + kTrianglesPerVertex * (kOrder + kTriangle);
    return field() + mesh() + (kSides + std::max(kPieces, stay)) * vertices();
  }

  /// The larger of: pieces, their areas and triangles; the triangles that stay, as if all did.
  [[nodiscard]] std::int64_t pick_pieces() const {
    if (!picks_pieces()) return 0;
    const std::int64_t stay = 2 * kOrder + kTrianglesPerVertex * (kOrder + kTriangle);
    return field() + mesh() + (1 + std::max(kPieces + kVertexKey, stay)) * vertices();
  }

  /// One pass of up to three attributes: their means with a weight at every node, their values at the vertices.
  [[nodiscard]] std::int64_t interpolate() const {
    const auto most = static_cast<std::int64_t>(field::kAttributesAtOnce);
    const std::int64_t at_once = std::min(attributes.averaged, most);
    if (at_once == 0) return 0;
    return kept() + kept_positions() + kept_counts() + mesh() + kNodeValue * (1 + at_once) * bricks +
           attributes.largest_mean * at_once * vertices();
  }

  /// The nearest sample of every vertex, and its label.
  [[nodiscard]] std::int64_t find_labels() const {
    if (attributes.count == attributes.averaged) return 0;
    return kept() + kept_positions() + kept_counts() + mesh() + (attributes.gaps ? kLabelled * points : 0) +
           (kOrder + attributes.largest_label) * vertices();
  }
};

}  // namespace

std::vector<PhaseBytes> model_memory(const RunSize& size, const Options& options) {
  const Model model(size, options);
  return {{"sort", model.sort()},
          {"find bricks", model.find_bricks()},
          {"build tree", model.build_tree()},
          {"density", model.density()},
          {"trim limit", model.trim_limit()},
          {"splat", model.splat()},
          {"solve", model.solve()},
          {"isovalue", model.isovalue()},
          {"distance", model.distance()},
          {"extract", model.extract()},
          {"trim", model.trim()},
          {"pieces", model.pick_pieces()},
          {"interpolate", model.interpolate()},
          {"labels", model.find_labels()}};
}

std::int64_t uploaded_bytes(std::int64_t points, const AttributeBytes& attributes) {
  return (kUploaded + attributes.uploaded) * points;
}

AttributeBytes bytes_of(const std::vector<Attribute>& attributes, bool kept) {
  AttributeBytes bytes;
  if (!kept) return bytes;
  for (const Attribute& attribute : attributes) {
    const auto width = static_cast<std::int64_t>(size_of(attribute.type()));
    const std::int64_t mask = attribute.values.has_mask() ? 1 : 0;
    ++bytes.count;
    bytes.uploaded += width + mask;
    if (attribute.is_label()) {
      bytes.sorted += width + mask;
      bytes.largest_label = std::max(bytes.largest_label, width + mask);
      bytes.gaps = bytes.gaps || mask > 0;
    } else {
      bytes.sorted += kShare;
      ++bytes.averaged;
      bytes.largest_mean = std::max(bytes.largest_mean, width);
    }
  }
  return bytes;
}

}  // namespace pointskin::detail
