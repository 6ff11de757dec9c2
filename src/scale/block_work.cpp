#include "scale/block_work.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "diagnose/in_blocks.hpp"
#include "diagnose/look.hpp"
#include "diagnose/look_at.hpp"
#include "diagnose/spread.hpp"
#include "exec/this_space.hpp"
#include "exec/typed_buffer.hpp"
#include "field/in_blocks.hpp"
#include "octree/octree_data.hpp"
#include "poisson/boundary.hpp"
#include "poisson/mean_length.hpp"
#include "poisson/spacing.hpp"
#include "poisson/trust.hpp"
#include "scale/attributes_of_samples.hpp"
#include "scale/block_labels.hpp"
#include "scale/staging.hpp"
#include "surface/extract.hpp"

namespace pointskin::scale {
namespace {

using octree::OctreeData;
using octree::OctreeView;
using poisson::Facing;
using poisson::Samples;

/// The samples of a block and its ring.
struct BlockSamples {
  Samples samples;
  exec::Buffer<std::uint64_t> keys;
  std::vector<field::Channel> channels;  ///< of the cloud's attributes, if they were asked for
  std::vector<field::Label> labels;      ///< the same
  exec::Buffer<float> weights;           ///< of the samples there
  std::int64_t first_own = 0, own = 0;   ///< where its own are
};

enum class With : std::uint8_t { samples, attributes };

/// The collapsed samples of a level, a cell at a time.
struct CollapsedOfCells {
  octree::LevelView level;
  poisson::ScreeningView collapsed;
  ArrayView<poisson::CollapsedSample> out;  // (cells)
  PSK_HD void operator()(std::int64_t cell) const {
    const bool is_empty = level.point_begin[cell] == level.point_begin[cell + 1];
    out[cell] = is_empty ? poisson::CollapsedSample{}
                         : collapsed.samples[8 * std::int64_t{collapsed.brick_index[cell >> 3]} + (cell & 7)];
  }
};

template <exec::Space Exec>
class WorkIn final : public BlockWork {
 public:
  WorkIn(Exec& ex, SharedOfBlocks& shared)
      : ex_(ex),
        shared_(shared),
        options_(shared.options),
        plan_(shared.plan),
        depth_(shared.options.depth),
        counts_(diagnose::make_counts(ex)) {}

  exec::MemoryPool& pool() override { return *ex_.pool(); }

  void sum_facing(const BlockRange& own) override {
    BlockSamples block = read(own, around_nodes(own), {});
    const int counted = poisson::counted_depth(depth_);
    const OctreeData tree = build(block, counted);
    const exec::Buffer<Facing> facing = poisson::sum_facing(ex_, tree, counted, block.samples);
    coarse().add_facing(own, fetched(of_last_coarse_level(tree, facing)).view());
  }

  void weigh(const BlockRange& own) override {
    BlockSamples block = read(own, around_nodes(own), {});
    const int counted = poisson::counted_depth(depth_);
    const OctreeData tree = build(block, counted);
    exec::Buffer<Facing> facing = poisson::sum_facing(ex_, tree, counted, block.samples);
    give(coarse().facing(), facing);
    const poisson::Weighed weighed =
        poisson::weigh_by_facing(ex_, tree, options_.samples_per_node, all_samples(), facing.cview(), block.samples);
    write_own(own, block, SampleValues::area, block.samples.areas);
    write_own(own, block, SampleValues::depth, block.samples.splat_depths);
    write_own(own, block, SampleValues::own_side, weighed.own_side);
    write_own(own, block, SampleValues::trust, weighed.bends);
    if (options_.trim != 0) write_spacing(own, block, tree, weighed.density);
    const exec::Buffer<std::int32_t> chosen =
        chosen_own(own, diagnose::kSamples, block.first_own, [](std::int64_t s) { return !diagnose::looks_across(s); });
    diagnose::look_at_densities(ex_, tree.view(), weighed.density, choose(chosen, block.samples.positions).cview(),
                                counts_);
  }

  void even_out(const BlockRange& own) override {
    BlockSamples block = read(own, around_nodes(own),
                              {{SampleValues::area, &Samples::areas},
                               {SampleValues::examined_depth, &Samples::splat_depths},
                               {SampleValues::trust, &Samples::trust}});
    const exec::Buffer<std::uint64_t> own_keys = part_of(block.keys, block.first_own, block.own);
    const OctreeData tree = build(block, depth_ - 1);
    Samples& samples = block.samples;
    const exec::Buffer<std::uint32_t> levels = poisson::even_out_depths(ex_, tree, samples);
    const octree::LevelView pooled = tree.view().levels[depth_ - 1];
    coarse().add_depths(own, depth_ - 1,
                        fetched(ArrayView<const std::uint64_t>{pooled.brick_key, pooled.cell_bricks}).view(),
                        fetched(levels.cview()).view());
    if (options_.screening > 0 && !options_.fixed_screening) poisson::weigh_trust(ex_, tree, samples);
    write_own(own, block, SampleValues::depth, samples.splat_depths);
    write_own(own, block, SampleValues::trust, samples.trust);
    const auto own_of = [&](const auto& column) { return fetched(column.cview().part(block.first_own, block.own)); };
    const auto positions = own_of(samples.positions), normals = own_of(samples.normals);
    const auto areas = own_of(samples.areas), depths = own_of(samples.splat_depths);
    coarse().add_samples(
        own, {fetched(own_keys.cview()).view(), positions.view(), normals.view(), areas.view(), depths.view()});
  }

  void splat(const BlockRange& own) override {
    BlockSamples block = read_weighed(own, around_nodes(own), With::attributes);
    const OctreeData tree = build(block);
    add_channels(own, tree, block);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    const exec::Buffer<float> b = divergence_of(tree, block.samples, resolution);
    coarse().add_divergence(own, fetched(of_last_coarse_level(tree, b)).view());
    if (options_.screening <= 0) return;
    const poisson::Screening collapsed = poisson::collapse_samples(ex_, tree, block.samples.view());
    for (int d = plan_.cut_level(); d <= plan_.level(); ++d) {
      const octree::LevelView level = tree.view().levels[d];
      auto cells = exec::make_buffer<poisson::CollapsedSample>(ex_, level.cells());
      for_each(ex_, "scale.collapsed", cells.size(), CollapsedOfCells{level, collapsed.view(d), cells.view()});
      coarse().add_collapsed(own, d, fetched(cells.cview()).view());
    }
  }

  std::unique_ptr<Spool> solve(const BlockRange& own, poisson::ValuesOfSamples& values) override {
    BlockSamples block = read_weighed(own, plan_.around_finer_nodes(own));
    const OctreeData tree = build(block);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    const exec::Buffer<float> b = divergence_of(tree, block.samples, resolution);
    poisson::Screening screening;
    if (options_.screening > 0) screening = poisson::collapse_samples(ex_, tree, block.samples.view());
    const OctreeView view = resolution.view(tree);
    auto u = exec::make_buffer<float>(ex_, view.nodes);
    give(coarse().u(), u);
    poisson::SolveOptions solving{options_.screening, options_.iterations};
    exec::Buffer<std::uint8_t> free;
    if (options_.boundary == Boundary::dirichlet) free = poisson::free_unknowns(ex_, view, true);
    solving.free_unknowns = free.cview();
    report_levels(own, tree.view(),
                  poisson::solve_below(ex_, view, b.cview(), screening, solving, plan_.level(), u.view()));
    values.add(poisson::values_at_samples(ex_, tree, u.cview(), block.samples.view(), own.begin, own.end));
    const std::int64_t given = coarse().u().size;
    const Fetched<float> finer = fetched(u.cview().part(given, u.size() - given));
    const std::int64_t bytes = finer.view().size * std::int64_t{sizeof(float)};
    auto field = std::make_unique<Spool>(options_.folder, bytes);
    field->write(shared_.host, 0, finer.data(), bytes);
    return field;
  }

  poisson::ValuesOfSamples sum_values(const BlockRange& own, const Spool& field, int fraction) override {
    BlockSamples block = read_weighed(own, plan_.around_finer_nodes(own));
    const OctreeData tree = build(block);
    const exec::Buffer<float> u = read_field(tree.view(), field);
    return poisson::values_at_samples(ex_, tree, u.cview(), block.samples.view(), own.begin, own.end, fraction);
  }

  void extract(const BlockRange& own, const Spool& field, const Extraction& what, BlockMeshes& meshes) override {
    BlockSamples block = read_weighed(own, plan_.around_finer_nodes(own), With::attributes);
    const OctreeData tree = build(block);
    poisson::Density density;
    const MeshColumns& columns = shared_.columns;
    const bool trims = columns.spacing != MeshColumns::kNone;
    if (what.supports || trims || options_.density_face > 0) density = density_of(tree, block.samples);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    Samples looked_at;
    if (what.looks) {
      const exec::Buffer<std::int32_t> chosen =
          chosen_own(own, diagnose::kSamples / diagnose::kSparse, block.first_own, [](std::int64_t) { return true; });
      looked_at.positions = choose(chosen, block.samples.positions);
      looked_at.splat_depths = choose(chosen, block.samples.splat_depths);
    }
    leave_attributes(block);
    const OctreeView view = resolution.view(tree);
    exec::Buffer<float> u = read_field(view, field);
    surface::SurfacePlaces places;
    surface::ExtractOptions extraction{options_.curvature, columns.normals != MeshColumns::kNone};
    extraction.places = &places;
    extraction.counted = {own.begin, own.end};
    field::FieldView function{view, u.data(), static_cast<float>(shared_.report.isovalue),
                              what.faces == DomainFaces::closed,
                              resolution.bricks.empty() ? nullptr : resolution.bricks.data()};
    if (what.looks) diagnose::look_at_field_of_block(ex_, function, looked_at.view(), own.begin, own.end, counts_);
    if (options_.isovalue) function.isovalue = static_cast<float>(*options_.isovalue);
    const surface::Surface surface = surface::extract_surface(ex_, function, extraction);
    shared_.report.lone_corners += surface.lone_corners;
    u.reset();
    exec::Buffer<float> per_cube, per_world;  // samples per area of the cube's unit, and of the world's
    exec::Buffer<float> spacing;
    const ArrayView<const Vec3f> vertices = surface.positions.cview();
    if (what.supports) per_cube = density_at(tree, density, vertices, std::ldexp(1.0, -2 * depth_));
    if (options_.density_face > 0) per_world = density_at(tree, density, vertices, options_.density_face);
    if (trims) {
      spacing = exec::make_buffer<float>(ex_, surface.positions.size());
      poisson::evaluate_spacing(ex_, tree, density, surface.positions.cview(), surface.normals.cview(), spacing.view());
    }
    density.counts.reset();
    add_mesh(own, surface, places,
             {std::move(per_cube), std::move(per_world), std::move(spacing),
              attributes_at(own, tree, block, vertices, places.keys.cview())},
             meshes);
  }

  PointValues values_at(const BlockRange& own, std::span<const Vec3f> points, std::span<const double> faces) override {
    BlockSamples block = read(own, plan_.around_finer_nodes(own), {}, With::attributes);
    const OctreeData tree = build(block);
    auto there = exec::make_buffer<Vec3f>(ex_, std::ssize(points));
    copy_to_device(ex_, points.data(), there.view());
    PointValues all;
    if (!faces.empty()) {
      const poisson::Density density = density_of(tree, block.samples);
      for (const double face : faces) {
        const exec::Buffer<float> values = density_at(tree, density, there.cview(), face);
        const Fetched<float> found = fetched(values.cview());
        all.densities.emplace_back(found.data(), found.data() + found.view().size);
      }
    }
    for (const exec::TypedBuffer& values : attributes_at(own, tree, block, there.cview(), {})) {
      const Fetched<std::uint8_t> found = fetched(values.bytes.cview());
      const auto* const bytes = reinterpret_cast<const std::byte*>(found.data());
      all.attributes.emplace_back(bytes, bytes + found.view().size);
    }
    return all;
  }

  diagnose::Counts looks() override { return diagnose::read_counts(ex_, counts_); }

 private:
  [[nodiscard]] CoarseLevels& coarse() { return *shared_.coarse; }
  [[nodiscard]] std::int64_t all_samples() const { return shared_.cloud.size(); }

  template <class T>
  Fetched<T> fetched(ArrayView<const T> values) {
    return Fetched<T>(ex_, shared_.host, values);
  }

  /// What is given of the levels up to K, to an array over the nodes of a block.
  template <class T>
  void give(ArrayView<const T> given, exec::Buffer<T>& nodes) {
    copy_to_device(ex_, given.data, nodes.view().part(0, given.size));
  }

  /// Of the block's own samples, for the limit of a cut.
  void write_spacing(const BlockRange& own, const BlockSamples& block, const OctreeData& tree,
                     const poisson::Density& density) {
    auto spacing = exec::make_buffer<float>(ex_, block.own);
    const auto own_of = [&](const exec::Buffer<Vec3f>& values) {
      return values.cview().part(block.first_own, block.own);
    };
    poisson::evaluate_spacing(ex_, tree, density, own_of(block.samples.positions), own_of(block.samples.normals),
                              spacing.view());
    shared_.values.write(SampleValues::spacing, own.samples.begin, fetched(spacing.cview()).view());
  }

  template <class T>
  exec::Buffer<T> part_of(const exec::Buffer<T>& from, std::int64_t first, std::int64_t count) {
    auto part = exec::make_buffer<T>(ex_, count);
    copy(ex_, from.cview().part(first, count), part.view());
    return part;
  }

  /// Of an array over the nodes of a block.
  template <class T>
  [[nodiscard]] ArrayView<const T> of_last_coarse_level(const OctreeData& tree, const exec::Buffer<T>& nodes) const {
    const octree::LevelView level = tree.view().levels[plan_.level()];
    return nodes.cview().part(level.first_node, level.nodes());
  }

  /// The cell bricks of the coarse levels, in the space.
  [[nodiscard]] std::span<const ArrayView<const std::uint64_t>> bricks() {
    if (bricks_.empty())
      for (const ArrayView<const std::uint64_t>& level : plan_.bricks()) {
        bricks_.emplace_back(ex_, level);
        brick_views_.push_back(bricks_.back().view());
      }
    return brick_views_;
  }

  [[nodiscard]] CellSet around_nodes(const BlockRange& own) { return plan_.around_nodes(own, coarse().last_level()); }

  /// Positions, unit normals and keys of the samples in cells of level K, and columns of values.
  BlockSamples read(const BlockRange& own, const CellSet& cells,
                    std::initializer_list<std::pair<SampleValues::Column, exec::Buffer<float> Samples::*>> columns,
                    With with = With::samples) {
    const std::vector<SampleRun> runs = plan_.samples_in(cells);
    std::int64_t n = 0;
    for (const SampleRun& run : runs) n += run.end - run.begin;
    BlockSamples block;
    block.own = own.samples.end - own.samples.begin;
    Sent<std::uint64_t> keys(shared_.host, n);
    Sent<Vec3f> positions(shared_.host, n), normals(shared_.host, n);
    const std::vector<PointAttribute>& attributes = shared_.cloud.attributes();
    AttributesOfSamples sent(shared_.host, attributes, with == With::attributes ? n : 0);
    Sent<float> weights(shared_.host,
                        with == With::attributes && options_.confidence && !shared_.passes.empty() ? n : 0);
    read_runs(runs, [&](std::int64_t first, std::int64_t count, std::int64_t at) {
      const AttributesOfSamples::Places to = sent.from(at);
      shared_.cloud.read(first, count,
                         {positions.data() + at, normals.data() + at, keys.data() + at, to.shares, to.raw});
      if (!weights.view().empty())  // as poisson::confidence_weights() has them
        std::transform(normals.data() + at, normals.data() + at + count, weights.data() + at, [&](const Vec3f& normal) {
          return static_cast<float>(poisson::length_of(normal) / shared_.mean_length);
        });
    });
    std::int64_t at = 0;
    for (const SampleRun& run : runs) {
      if (run.begin <= own.samples.begin && own.samples.begin < run.end)
        block.first_own = at + own.samples.begin - run.begin;
      at += run.end - run.begin;
    }
    if (with == With::attributes) sent.to(ex_, block.channels, block.labels);
    block.weights = weights.to(ex_);
    block.keys = keys.to(ex_);
    block.samples.positions = positions.to(ex_);
    block.samples.normals = normals.to(ex_);
    poisson::normalise_normals(ex_, block.samples.normals.view());
    for (const auto& [column, member] : columns) block.samples.*member = read_column(column, runs, n);
    shared_.report.most_samples = std::max(shared_.report.most_samples, n);
    shared_.report.samples_read += n;
    return block;
  }

  exec::Buffer<float> read_column(SampleValues::Column column, const std::vector<SampleRun>& runs, std::int64_t n) {
    Sent<float> values(shared_.host, n);
    read_runs(runs, [&](std::int64_t first, std::int64_t count, std::int64_t at) {
      shared_.values.read(column, first, values.view().part(at, count));
    });
    return values.to(ex_);
  }

  /// Calls read(first sample, count, place among those of all runs) for parts of all runs, on all threads.
  template <class Read>
  void read_runs(const std::vector<SampleRun>& runs, const Read& read) {
    struct Part {
      std::int64_t first, count, at;
    };
    constexpr std::int64_t kMost = 64 << 10;
    std::vector<Part> parts;
    std::int64_t at = 0;
    for (const SampleRun& run : runs)
      for (std::int64_t first = run.begin; first < run.end; first += parts.back().count) {
        parts.push_back({first, std::min(kMost, run.end - first), at});
        at += parts.back().count;
      }
    shared_.host.run_blocks(std::ssize(parts), [&](std::int64_t i) {
      const Part& part = parts[static_cast<std::size_t>(i)];
      read(part.first, part.count, part.at);
    });
  }

  /// Samples of a block as the solver needs them.
  BlockSamples read_weighed(const BlockRange& own, const CellSet& cells, With with = With::samples) {
    BlockSamples block = read(own, cells,
                              {{SampleValues::area, &Samples::areas},
                               {SampleValues::depth, &Samples::splat_depths},
                               {SampleValues::trust, &Samples::trust}},
                              with);
    if (options_.screening <= 0 || options_.fixed_screening) block.samples.trust.reset();
    coarse().set_depths(block.samples);
    return block;
  }

  /// Frees all but what attributes_at() needs.
  static void leave_attributes(BlockSamples& block) {
    BlockSamples rest;
    rest.channels = std::move(block.channels);
    rest.labels = std::move(block.labels);
    if (!rest.channels.empty() || !rest.labels.empty()) rest.samples.positions = std::move(block.samples.positions);
    rest.weights = std::move(block.weights);
    block = std::move(rest);
  }

  /// Calls visit(pass, samples) for channels that share a pass.
  template <class Visit>
  void for_passes(const BlockSamples& block, const Visit& visit) {
    std::size_t first = 0;
    for (std::size_t pass = 0; pass < shared_.passes.size(); ++pass) {
      const std::size_t count = shared_.passes[pass];
      visit(pass, field::ChannelSamples{block.samples.positions.cview(), block.weights.cview(),
                                        std::span(block.channels).subspan(first, count)});
      first += count;
    }
  }

  /// What the block adds to the attributes of the coarse levels. They are freed.
  void add_channels(const BlockRange& own, const OctreeData& tree, BlockSamples& block) {
    const octree::LevelView level = tree.view().levels[plan_.level()];
    for_passes(block, [&](std::size_t pass, const field::ChannelSamples& samples) {
      const auto width = static_cast<std::int64_t>(1 + samples.channels.size());
      const exec::Buffer<float> means = field::channel_means_below(ex_, tree, samples, plan_.level());
      coarse().add_channels(own, pass,
                            fetched(means.cview().part(level.first_node * width, level.nodes() * width)).view());
    });
    block.channels.clear();
    block.labels.clear();
    block.weights.reset();
  }

  /// The cloud's attributes at points in the block's own cells.
  /// @param keys  of the vertices that these are, as find_labels_of_block() has them
  std::vector<exec::TypedBuffer> attributes_at(const BlockRange& own, const OctreeData& tree, const BlockSamples& block,
                                               ArrayView<const Vec3f> points, ArrayView<const std::uint64_t> keys) {
    std::vector<exec::TypedBuffer> values(block.channels.size() + block.labels.size());
    const auto take = [&](std::size_t place, exec::TypedBuffer found) { values[place] = std::move(found); };
    for_passes(block, [&](std::size_t pass, const field::ChannelSamples& samples) {
      const Lent<float> given(ex_, coarse().channels(pass));
      field::interpolate_below(ex_, tree, samples, plan_.level(), given.view(), points, take);
    });
    if (!block.labels.empty())
      find_labels_of_block(ex_, shared_, own, {tree, block.samples.positions.cview(), block.labels}, points, keys,
                           take);
    return values;
  }

  void write_own(const BlockRange& own, const BlockSamples& block, SampleValues::Column column,
                 const exec::Buffer<float>& values) {
    shared_.values.write(column, own.samples.begin, fetched(values.cview().part(block.first_own, block.own)).view());
  }

  OctreeData build(BlockSamples& block) { return build(block, depth_); }

  /// Without levels that are finer than `finest`.
  OctreeData build(BlockSamples& block, int finest) {
    OctreeData tree = octree::build_octree_below(ex_, block.keys.cview(), depth_, bricks(), finest);
    block.keys.reset();
    shared_.report.most_nodes = std::max(shared_.report.most_nodes, tree.nodes());
    return tree;
  }

  /// Where samples of the whole cloud that are looked at, evenly spread, lie among those of a block.
  /// @param first_own  place of the block's first own sample there
  template <class Choose>
  exec::Buffer<std::int32_t> chosen_own(const BlockRange& own, std::int64_t some, std::int64_t first_own,
                                        const Choose& is_chosen) {
    const diagnose::Spread spread{std::min(all_samples(), some), all_samples()};
    std::vector<std::int32_t> chosen;
    for (std::int64_t s = spread.first_from(own.samples.begin); s < spread.some && spread(s) < own.samples.end; ++s)
      if (is_chosen(s)) chosen.push_back(static_cast<std::int32_t>(first_own + spread(s) - own.samples.begin));
    auto there = exec::make_buffer<std::int32_t>(ex_, std::ssize(chosen));
    copy_to_device(ex_, chosen.data(), there.view());
    return there;
  }

  template <class T>
  exec::Buffer<T> choose(const exec::Buffer<std::int32_t>& chosen, const exec::Buffer<T>& from) {
    auto to = exec::make_buffer<T>(ex_, chosen.size());
    exec::gather<T>(ex_, from.cview(), chosen.cview(), to.view());
    return to;
  }

  poisson::Resolution resolution_of(const OctreeData& tree, const Samples& samples) {
    if (!coarse().is_sparse()) return {};
    const Lent<std::uint8_t> given(ex_, coarse().resolved_bricks());
    return poisson::resolution_of(ex_, tree.view(), poisson::resolved_below(ex_, tree.view(), samples, given.view()));
  }

  exec::Buffer<float> divergence_of(const OctreeData& tree, const Samples& samples,
                                    const poisson::Resolution& resolution) {
    const Lent<float> given(ex_, coarse().field());
    return poisson::splat_divergence_below(ex_, tree, samples.view(), resolution, plan_.level(), given.view());
  }

  /// The field of a block's octree.
  exec::Buffer<float> read_field(const OctreeView& tree, const Spool& field) {
    const std::int64_t given = coarse().u().size;
    Sent<float> u(shared_.host, tree.nodes);
    std::copy_n(coarse().u().data, given, u.data());
    field.read(shared_.host, 0, u.data() + given, field.size());
    return u.to(ex_);
  }

  /// Adds what a block has of its own.
  void report_levels(const BlockRange& own, const OctreeView& tree, const std::vector<poisson::LevelSolve>& solved) {
    std::vector<LevelReport>& levels = shared_.report.levels;
    for (const poisson::LevelSolve& found : solved) {
      const auto place = static_cast<std::size_t>(found.depth);
      if (levels.size() <= place) levels.push_back({found.depth, 0, 0, found.iterations, 0, 0});
      const octree::LevelView& level = tree.levels[found.depth];
      const Fetched<std::uint64_t> bricks = fetched(ArrayView<const std::uint64_t>{level.brick_key, level.cell_bricks});
      const auto bricks_before = [&](std::uint64_t cell) {
        return std::lower_bound(bricks.view().begin(), bricks.view().end(), cell >> 3 * (depth_ - found.depth + 1)) -
               bricks.view().begin();
      };
      levels[place].nodes += 8 * (bricks_before(own.end) - bricks_before(own.begin));
    }
  }

  /// As the whole has it, at nodes around which all samples are there.
  poisson::Density density_of(const OctreeData& tree, const Samples& samples) {
    poisson::Density density = poisson::splat_density(ex_, tree, samples.positions.cview());
    give(coarse().counts(), density.counts);
    return density;
  }

  /// Samples per area.
  /// @param face  area of a face of a finest cell
  exec::Buffer<float> density_at(const OctreeData& tree, const poisson::Density& density, ArrayView<const Vec3f> points,
                                 double face) {
    auto values = exec::make_buffer<float>(ex_, points.size);
    poisson::evaluate_density(ex_, tree, density, points, values.view());
    for_each(ex_, "scale.density", values.size(), poisson::PerArea{face, values.view()});
    return values;
  }

  /// Values at the vertices of an extracted surface, those that are needed.
  struct ValuesOfVertices {
    exec::Buffer<float> per_cube, per_world, spacing;
    std::vector<exec::TypedBuffer> attributes;
  };
  void add_mesh(const BlockRange& own, const surface::Surface& surface, const surface::SurfacePlaces& places,
                const ValuesOfVertices& values, BlockMeshes& meshes) {
    const auto positions = fetched(surface.positions.cview()), normals = fetched(surface.normals.cview());
    const auto densities = fetched(values.per_world.cview()), supports = fetched(values.per_cube.cview());
    const auto spacing = fetched(values.spacing.cview());
    const auto triangles = fetched(surface.triangles.cview());
    const auto keys = fetched(places.keys.cview()), cells = fetched(places.cells.cview());
    const auto segments = fetched(places.segments.cview());
    const MeshColumns& all = shared_.columns;
    std::vector<const std::byte*> columns(all.bytes.size());
    const auto set = [&](std::size_t column, const auto& of_vertices) {
      if (column != MeshColumns::kNone) columns[column] = reinterpret_cast<const std::byte*>(of_vertices.data());
    };
    columns[0] = reinterpret_cast<const std::byte*>(positions.data());
    set(all.normals, normals);
    set(all.density, densities);
    set(all.spacing, spacing);
    set(all.supports, supports);
    std::vector<Fetched<std::uint8_t>> attributes;
    for (const exec::TypedBuffer& column : values.attributes) attributes.push_back(fetched(column.bytes.cview()));
    for (std::size_t i = 0; i < attributes.size(); ++i) set(all.attributes + i, attributes[i]);
    const auto span = [](const auto& from) {
      return std::span(from.data(), static_cast<std::size_t>(from.view().size));
    };
    meshes.add(shared_.host,
               {own.begin, own.end, span(keys), columns, span(triangles), span(cells), span(segments), span(supports)});
  }

  Exec& ex_;
  SharedOfBlocks& shared_;
  const BlockOptions& options_;
  const BlockPlan& plan_;
  int depth_;
  exec::Buffer<diagnose::Counts> counts_;
  std::vector<Lent<std::uint64_t>> bricks_;
  std::vector<ArrayView<const std::uint64_t>> brick_views_;
};

}  // namespace

template <exec::Space Exec>
std::unique_ptr<BlockWork> make_block_work(Exec& ex, SharedOfBlocks& shared) {
  return std::make_unique<WorkIn<Exec>>(ex, shared);
}

PSK_INSTANTIATE(make_block_work);

}  // namespace pointskin::scale
