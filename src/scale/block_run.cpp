#include "scale/block_run.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/announce.hpp"
#include "core/format.hpp"
#include "diagnose/in_blocks.hpp"
#include "diagnose/look.hpp"
#include "diagnose/look_at.hpp"
#include "diagnose/spread.hpp"
#include "diagnose/verdict.hpp"
#include "exec/cpu_primitives.hpp"
#include "exec/exact_sum.hpp"
#include "octree/octree_data.hpp"
#include "poisson/boundary.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/mean_length.hpp"
#include "poisson/trust.hpp"
#include "reconstruct/pieces_by_support.hpp"
#include "scale/block_looks.hpp"
#include "scale/block_plan.hpp"
#include "scale/cell_set.hpp"
#include "scale/coarse_levels.hpp"
#include "scale/key_index.hpp"
#include "scale/sample_values.hpp"
#include "scale/spool.hpp"
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
  std::int64_t first_own = 0, own = 0;  ///< where its own are
};

/// Limits what buffers may take together as long as it is there; 0: they may take what they like.
class LimitOfPool {
 public:
  LimitOfPool(exec::Cpu& ex, std::int64_t bytes) : ex_(ex) { ex_.pool()->set_limit(bytes); }
  ~LimitOfPool() { ex_.pool()->set_limit(0); }
  LimitOfPool(const LimitOfPool&) = delete;
  LimitOfPool& operator=(const LimitOfPool&) = delete;

 private:
  exec::Cpu& ex_;
};

BlockPlan::Setup plan_setup(std::int64_t samples, const BlockOptions& options) {
  BlockPlan::Setup setup;
  setup.depth = options.depth;
  setup.coarse_level = options.coarse_level;
  setup.blocks = options.blocks;
  setup.memory_bytes = options.memory_bytes;
  setup.part_samples = options.part_samples;
  setup.iterations = options.iterations;
  setup.ring = options.ring;
  setup.lowest_splat_depth = poisson::coarsest_splat_depth(samples, options.depth);
  return setup;
}

class BlockRun {
 public:
  BlockRun(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options, BlockReport& report)
      : ex_(ex),
        cloud_(cloud),
        options_(options),
        report_(report),
        depth_(options.depth),
        plan_(ex, cloud, plan_setup(cloud.size(), options)),
        values_(options.folder, cloud.size()),
        counts_(diagnose::make_counts(ex)) {}

  BlockMeshes run() {
    sweep({"bricks", "octree", 0.05}, [&] { plan_.find_bricks(); });
    sweep({"plan", "octree", 0.08}, [&] {
      plan_.divide();
      coarse_.emplace(ex_, plan_,
                      CoarseLevels::Setup{options_.screening, options_.iterations, options_.boundary, needs_counts()});
      report_.blocks = static_cast<int>(plan_.blocks().size());
      report_.coarse_level = plan_.level();
      report_.coarse_nodes = coarse_->nodes();
    });
    const LimitOfPool limit(ex_, options_.holds_to_memory ? options_.memory_bytes : 0);
    over_blocks({"sums", "splat", 0.1}, [&](const BlockRange& own) { sum_facing(own); });
    coarse_->finish_facing();
    over_blocks({"weights", "splat", 0.16}, [&](const BlockRange& own) { weigh(own); });
    coarse_->drop_facing();
    sweep({"examine", "splat", 0.22}, [&] { examine(); });
    over_blocks({"depths", "splat", 0.23}, [&](const BlockRange& own) { even_out(own); });
    const KeyIndex index(cloud_, plan_.level(), plan_.cells(), plan_.first());
    sweep({"look at samples", "splat", 0.27}, [&] { look_at_pairs(ex_, cloud_, values_, index, depth_, looks()); });
    sweep({"coarse field", "splat", 0.27}, [&] { coarse_->splat(); });
    over_blocks({"splat", "splat", 0.27}, [&](const BlockRange& own) { splat(own); });
    sweep({"coarse solve", "solve", 0.4}, [&] { solve_coarse(); });
    poisson::ValuesOfSamples values;
    std::vector<std::unique_ptr<Spool>> fields;
    over_blocks({"solve", "solve", 0.4}, [&](const BlockRange& own) { fields.push_back(solve(own, values)); });
    report_.isovalue = mean_of(values, fields);
    BlockMeshes meshes = extract_all(fields);
    sweep({"look at triangles", "extract", 0.98}, [&] {
      const int far_depth = diagnose::far_depth(diagnose::findings_of(looks()), depth_);
      look_at_triangles(meshes, index, far_depth, looks());
    });
    report_.looks = looks();
    return meshes;
  }

 private:
  [[nodiscard]] std::vector<std::int64_t> columns() const {
    std::vector<std::int64_t> columns{sizeof(Vec3f)};
    if (options_.normals) columns.push_back(sizeof(Vec3f));
    if (options_.density_face > 0) columns.push_back(sizeof(float));
    return columns;
  }

  [[nodiscard]] bool picks_by_support() const {
    return detail::picks_pieces_by_support(options_.largest, options_.min_component);
  }
  [[nodiscard]] double fewest_samples() const {
    if (!picks_by_support()) return 0;
    return detail::fewest_samples(diagnose::findings_of(looks()).lonely > 0, report_.lone_corners);
  }
  [[nodiscard]] bool needs_counts() const { return picks_by_support() || options_.density_face > 0; }

  /// Whether pieces without samples go is known once all is extracted: then once more, with pieces.
  BlockMeshes extract_all(std::vector<std::unique_ptr<Spool>>& fields) {
    surface::PieceOptions pieces{options_.largest, options_.min_component, fewest_samples()};
    const auto looks_for_pieces = [&] { return pieces.largest || pieces.least > 0 || pieces.least_samples > 0; };
    const bool may_come_again = picks_by_support() && !looks_for_pieces();
    BlockMeshes meshes = start_meshes(looks_for_pieces());
    std::size_t block = 0;
    over_blocks({"extract", "extract", 0.8}, [&](const BlockRange& own) {
      extract(own, *fields[block], {pieces.least_samples > 0, true}, meshes);
      if (!may_come_again) fields[block].reset();
      ++block;
    });
    pieces.least_samples = fewest_samples();
    if (may_come_again && looks_for_pieces()) {
      meshes = start_meshes(true);
      block = 0;
      over_blocks({"extract again", "extract", 0.9}, [&](const BlockRange& own) {
        extract(own, *fields[block++], {true, false}, meshes);
      });
    }
    fields.clear();
    sweep({"join", "extract", 0.98}, [&] {
      meshes.finish();
      if (looks_for_pieces() && meshes.triangles() > 0) report_.pieces = meshes.keep_pieces(pieces);
    });
    return meshes;
  }

  [[nodiscard]] BlockMeshes start_meshes(bool pieces) const {
    return BlockMeshes({options_.folder, depth_, plan_.level(), columns(), pieces});
  }

  [[nodiscard]] diagnose::Counts& looks() const { return *counts_.data(); }

  /// A pass over all samples or blocks.
  struct Pass {
    const char* name;   ///< in the report
    const char* phase;  ///< as callers of Options::progress know it
    double fraction;    ///< of the run that is done when it begins
  };
  template <class Work>
  void sweep(const Pass& pass, const Work& work) {
    announce(options_.progress, pass.phase, pass.fraction);
    ex_.pool()->trim();  // what another pass left, in other sizes, is no use
    const auto begin = std::chrono::steady_clock::now();
    work();
    report_.sweeps.push_back(
        {pass.name, pass.phase, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
  }
  template <class Work>
  void over_blocks(const Pass& pass, const Work& work) {
    sweep(pass, [&] {
      for (const BlockRange& own : plan_.blocks()) {
        announce(options_.progress, pass.phase, pass.fraction);
        work(own);
      }
    });
  }

  /// Positions, unit normals and keys of the samples in cells of level K, and columns of values.
  BlockSamples read(const BlockRange& own, const CellSet& cells, bool normals,
                    std::initializer_list<std::pair<SampleValues::Column, exec::Buffer<float> Samples::*>> columns) {
    const std::vector<SampleRun> runs = plan_.samples_in(cells);
    std::int64_t n = 0;
    for (const SampleRun& run : runs) n += run.end - run.begin;
    BlockSamples block{{}, exec::make_buffer<std::uint64_t>(ex_, n), 0, own.samples.end - own.samples.begin};
    block.samples.positions = exec::make_buffer<Vec3f>(ex_, n);
    if (normals) block.samples.normals = exec::make_buffer<Vec3f>(ex_, n);
    for (const auto& [column, member] : columns) block.samples.*member = exec::make_buffer<float>(ex_, n);
    std::int64_t at = 0;
    for (const SampleRun& run : runs) {
      const std::int64_t count = run.end - run.begin;
      cloud_.read(run.begin, count,
                  {block.samples.positions.data() + at, normals ? block.samples.normals.data() + at : nullptr,
                   block.keys.data() + at});
      for (const auto& [column, member] : columns)
        values_.read(column, run.begin, (block.samples.*member).view().part(at, count));
      if (run.begin <= own.samples.begin && own.samples.begin < run.end)
        block.first_own = at + own.samples.begin - run.begin;
      at += count;
    }
    poisson::normalise_normals(ex_, block.samples.normals.view());
    report_.most_samples = std::max(report_.most_samples, n);
    report_.samples_read += n;
    return block;
  }

  OctreeData build(BlockSamples& block) {
    OctreeData tree = octree::build_octree_below(ex_, block.keys.cview(), depth_, plan_.bricks());
    block.keys.reset();
    report_.most_nodes = std::max(report_.most_nodes, tree.nodes());
    return tree;
  }

  [[nodiscard]] CellSet around_nodes(const BlockRange& own) const {
    return plan_.around_nodes(own, coarse_->last_level());
  }

  void sum_facing(const BlockRange& own) {
    BlockSamples block = read(own, around_nodes(own), true, {});
    const int counted = poisson::counted_depth(depth_);
    const OctreeData tree = octree::build_octree_below(ex_, block.keys.cview(), counted, plan_.bricks());
    coarse_->add_facing(own, poisson::sum_facing(ex_, tree, counted, block.samples).cview());
  }

  void weigh(const BlockRange& own) {
    BlockSamples block = read(own, around_nodes(own), true, {});
    const OctreeData tree = build(block);
    exec::Buffer<Facing> facing = poisson::sum_facing(ex_, tree, poisson::counted_depth(depth_), block.samples);
    give(coarse_->facing(), facing);
    const poisson::Weighed weighed =
        poisson::weigh_by_facing(ex_, tree, options_.samples_per_node, cloud_.size(), facing.cview(), block.samples);
    write_own(own, block, SampleValues::area, block.samples.areas);
    write_own(own, block, SampleValues::depth, block.samples.splat_depths);
    write_own(own, block, SampleValues::own_side, weighed.own_side);
    write_own(own, block, SampleValues::trust, weighed.bends);
    const std::vector<std::int64_t> chosen =
        chosen_own(own, diagnose::kSamples, block.first_own, [](std::int64_t s) { return !diagnose::looks_across(s); });
    diagnose::look_at_densities(ex_, tree.view(), weighed.density,
                                choose(chosen, block.samples.positions.cview()).cview(), counts_);
  }

  /// Where samples of the whole cloud that are looked at, evenly spread, lie among those of a block.
  /// @param first_own  place of the block's first own sample there
  template <class Choose>
  [[nodiscard]] std::vector<std::int64_t> chosen_own(const BlockRange& own, std::int64_t some, std::int64_t first_own,
                                                     const Choose& is_chosen) const {
    const diagnose::Spread spread{std::min(cloud_.size(), some), cloud_.size()};
    std::vector<std::int64_t> chosen;
    for (std::int64_t s = spread.first_from(own.samples.begin); s < spread.some && spread(s) < own.samples.end; ++s)
      if (is_chosen(s)) chosen.push_back(first_own + spread(s) - own.samples.begin);
    return chosen;
  }

  template <class T>
  exec::Buffer<T> choose(const std::vector<std::int64_t>& chosen, ArrayView<const T> from) {
    auto to = exec::make_buffer<T>(ex_, std::ssize(chosen));
    std::transform(chosen.begin(), chosen.end(), to.data(), [&](std::int64_t i) { return from[i]; });
    return to;
  }

  /// What is given of the levels up to K, to an array over the nodes of a block.
  template <class T>
  void give(ArrayView<const T> given, exec::Buffer<T>& nodes) {
    copy(ex_, given, nodes.view().part(0, given.size));
  }

  void write_own(const BlockRange& own, const BlockSamples& block, SampleValues::Column column,
                 const exec::Buffer<float>& values) const {
    values_.write(column, own.samples.begin, values.cview().part(block.first_own, block.own));
  }

  /// Calls step(part, samples, own_side) for parts of the samples in their order, with those before and after.
  template <class Step>
  void for_parts(const Step& step) {
    const std::int64_t n = cloud_.size();
    for (std::int64_t first = 0; first < n; first += options_.part_samples) {
      const std::int64_t begin = std::max<std::int64_t>(0, first - poisson::kExamineReach);
      const std::int64_t end = std::min(n, first + options_.part_samples + poisson::kExamineReach);
      const poisson::PartOfCloud part{first, std::min(options_.part_samples, n - first), first - begin, n};
      const auto column = [&](SampleValues::Column which) {
        auto values = exec::make_buffer<float>(ex_, end - begin);
        values_.read(which, begin, values.view());
        return values;
      };
      Samples samples;
      samples.positions = exec::make_buffer<Vec3f>(ex_, end - begin);
      samples.normals = exec::make_buffer<Vec3f>(ex_, end - begin);
      cloud_.read(begin, end - begin, {samples.positions.data(), samples.normals.data()});
      poisson::normalise_normals(ex_, samples.normals.view());
      samples.areas = column(SampleValues::area);
      samples.splat_depths = column(SampleValues::depth);
      step(part, samples, column(SampleValues::own_side));
    }
  }

  void examine() {
    const double mean = options_.confidence ? mean_length() : 0;
    poisson::LookAtCloud look;
    for_parts([&](const poisson::PartOfCloud& part, const Samples& samples, const exec::Buffer<float>& own_side) {
      look.add(poisson::look_at_part(ex_, depth_, part, own_side.cview(), samples));
    });
    for_parts([&](const poisson::PartOfCloud& part, Samples& samples, exec::Buffer<float> own_side) {
      auto bends = exec::make_buffer<float>(ex_, samples.areas.size());
      values_.read(SampleValues::trust, part.first - part.before, bends.view());
      poisson::examine_part(ex_, depth_, poisson::coarsest_splat_depth(cloud_.size(), depth_), part, look,
                            std::move(own_side), std::move(bends), samples);
      if (options_.confidence) scale_areas(part, mean, samples.areas.view());
      looks().sums[diagnose::kLonely] += *samples.lonely.data();
      for (std::int64_t i = part.before; i < part.before + part.count; ++i)
        if (samples.areas.data()[i] > 0) report_.inliers.add(samples.positions.data()[i]);
      const auto own = [&](const exec::Buffer<float>& values) { return values.cview().part(part.before, part.count); };
      values_.write(SampleValues::area, part.first, own(samples.areas));
      values_.write(SampleValues::examined_depth, part.first, own(samples.splat_depths));
      values_.write(SampleValues::trust, part.first, own(samples.trust));
    });
  }

  /// Calls visit(normal) with all normals as they were given.
  template <class Visit>
  void for_normals(std::int64_t first, std::int64_t count, const Visit& visit) const {
    std::vector<Vec3f> normals;
    for (const std::int64_t end = first + count; first < end; first += std::ssize(normals)) {
      normals.resize(static_cast<std::size_t>(std::min(options_.part_samples, end - first)));
      cloud_.read(first, std::ssize(normals), {nullptr, normals.data()});
      for (const Vec3f& normal : normals) visit(normal);
    }
  }

  /// As poisson::mean_length() has it.
  [[nodiscard]] double mean_length() const {
    double largest = 0;
    const auto sum_in = [&](int fraction) {
      exec::ExactSum sum;
      for_normals(0, cloud_.size(), [&](const Vec3f& normal) {
        const double length = poisson::length_of(normal);
        largest = exec::Largest{}(largest, length);
        sum = exec::AddExactly{}(sum, exec::exact_term(length, fraction));
      });
      return sum;
    };
    const auto n = static_cast<double>(cloud_.size());
    const exec::ExactSum sum = sum_in(poisson::kLengthFraction);
    if (sum.reliable(cloud_.size())) return sum.value(poisson::kLengthFraction) / n;
    if (!std::isfinite(largest)) return std::numeric_limits<double>::quiet_NaN();
    if (largest == 0) return 0;
    const int fraction = exec::fraction_for(largest);
    return sum_in(fraction).value(fraction) / n;
  }

  /// By the lengths of the normals, over their mean.
  void scale_areas(const poisson::PartOfCloud& part, double mean, ArrayView<float> areas) const {
    std::int64_t i = part.before;
    for_normals(part.first, part.count,
                [&](const Vec3f& normal) { areas[i++] *= static_cast<float>(poisson::length_of(normal) / mean); });
  }

  /// Depths become final, and trust.
  void even_out(const BlockRange& own) {
    BlockSamples block = read(own, around_nodes(own), true,
                              {{SampleValues::area, &Samples::areas},
                               {SampleValues::examined_depth, &Samples::splat_depths},
                               {SampleValues::trust, &Samples::trust}});
    std::vector<std::uint64_t> own_keys(block.keys.data() + block.first_own,
                                        block.keys.data() + block.first_own + block.own);
    const OctreeData tree = build(block);
    Samples& samples = block.samples;
    const exec::Buffer<std::uint32_t> levels = poisson::even_out_depths(ex_, tree, samples);
    coarse_->add_depths(own, tree.view().levels[depth_ - 1], levels.cview());
    if (options_.screening > 0 && !options_.fixed_screening) poisson::weigh_trust(ex_, tree, samples);
    write_own(own, block, SampleValues::depth, samples.splat_depths);
    write_own(own, block, SampleValues::trust, samples.trust);
    coarse_->add_samples(own, block.first_own, samples, own_keys);
  }

  /// Samples of a block as the solver needs them.
  BlockSamples read_weighed(const BlockRange& own, const CellSet& cells) {
    BlockSamples block = read(own, cells, true,
                              {{SampleValues::area, &Samples::areas},
                               {SampleValues::depth, &Samples::splat_depths},
                               {SampleValues::trust, &Samples::trust}});
    if (options_.screening <= 0 || options_.fixed_screening) block.samples.trust.reset();
    coarse_->set_depths(block.samples);
    return block;
  }

  poisson::Resolution resolution_of(const OctreeData& tree, const Samples& samples) {
    if (!coarse_->is_sparse()) return {};
    return poisson::resolution_of(ex_, tree.view(),
                                  poisson::resolved_below(ex_, tree.view(), samples, coarse_->resolved_bricks()));
  }

  /// What a block adds to the systems of levels up to K.
  void splat(const BlockRange& own) {
    BlockSamples block = read_weighed(own, around_nodes(own));
    const OctreeData tree = build(block);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    coarse_->add_divergence(own, divergence_of(tree, block.samples, resolution).cview());
    if (options_.screening <= 0) return;
    coarse_->add_collapsed(own, tree.view(), poisson::collapse_samples(ex_, tree, block.samples.view()));
  }

  exec::Buffer<float> divergence_of(const OctreeData& tree, const Samples& samples,
                                    const poisson::Resolution& resolution) {
    return poisson::splat_divergence_below(ex_, tree, samples.view(), resolution, plan_.level(), coarse_->field());
  }

  void solve_coarse() {
    for (const poisson::LevelSolve& level : coarse_->solve())
      report_.levels.push_back(
          {level.depth, coarse_->tree().view().levels[level.depth].cells(), 0, level.iterations, 0, 0});
  }

  /// @returns the fields of the finer levels
  std::unique_ptr<Spool> solve(const BlockRange& own, poisson::ValuesOfSamples& values) {
    BlockSamples block = read_weighed(own, plan_.around_finer_nodes(own));
    const OctreeData tree = build(block);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    const exec::Buffer<float> b = divergence_of(tree, block.samples, resolution);
    poisson::Screening screening;
    if (options_.screening > 0) screening = poisson::collapse_samples(ex_, tree, block.samples.view());
    const OctreeView view = resolution.view(tree);
    auto u = exec::make_buffer<float>(ex_, view.nodes);
    give(coarse_->u(), u);
    poisson::SolveOptions solving{options_.screening, options_.iterations};
    exec::Buffer<std::uint8_t> free;
    if (options_.boundary == Boundary::dirichlet) free = poisson::free_unknowns(ex_, view, true);
    solving.free_unknowns = free.cview();
    report_levels(own, tree.view(),
                  poisson::solve_below(ex_, view, b.cview(), screening, solving, plan_.level(), u.view()));
    values.add(poisson::values_at_samples(ex_, tree, u.cview(), block.samples.view(), own.begin, own.end));
    const std::int64_t given = coarse_->u().size;
    const std::int64_t bytes = (u.size() - given) * std::int64_t{sizeof(float)};
    auto field = std::make_unique<Spool>(options_.folder, bytes);
    field->write(0, u.data() + given, bytes);
    return field;
  }

  /// The field of a block's octree.
  exec::Buffer<float> read_field(const OctreeView& tree, const Spool& field) {
    auto u = exec::make_buffer<float>(ex_, tree.nodes);
    give(coarse_->u(), u);
    field.read(0, u.data() + coarse_->u().size, field.size());
    return u;
  }

  /// As poisson::mean_at_samples() has it: values that are far from 1/2 are summed up once more, in another unit.
  double mean_of(const poisson::ValuesOfSamples& values, const std::vector<std::unique_ptr<Spool>>& fields) {
    if (values.reliable()) return values.mean(poisson::ValuesOfSamples::kFraction);
    if (!std::isfinite(values.largest)) return std::numeric_limits<double>::quiet_NaN();
    if (values.largest == 0) return 0;
    const int fraction = exec::fraction_for(values.largest);
    poisson::ValuesOfSamples again;
    std::size_t number = 0;
    over_blocks({"sum again", "solve", 0.79}, [&](const BlockRange& own) {
      BlockSamples block = read_weighed(own, plan_.around_finer_nodes(own));
      const OctreeData tree = build(block);
      const exec::Buffer<float> u = read_field(tree.view(), *fields[number++]);
      again.add(poisson::values_at_samples(ex_, tree, u.cview(), block.samples.view(), own.begin, own.end, fraction));
    });
    return again.mean(fraction);
  }

  /// Adds what a block has of its own.
  void report_levels(const BlockRange& own, const OctreeView& tree, const std::vector<poisson::LevelSolve>& solved) {
    for (const poisson::LevelSolve& found : solved) {
      const auto place = static_cast<std::size_t>(found.depth);
      if (report_.levels.size() <= place) report_.levels.push_back({found.depth, 0, 0, found.iterations, 0, 0});
      const octree::LevelView& level = tree.levels[found.depth];
      const auto bricks_before = [&](std::uint64_t cell) {
        return std::lower_bound(level.brick_key, level.brick_key + level.cell_bricks,
                                cell >> 3 * (depth_ - found.depth + 1)) -
               level.brick_key;
      };
      report_.levels[place].nodes += 8 * (bricks_before(own.end) - bricks_before(own.begin));
    }
  }

  /// What an extraction is for besides the surface.
  struct Extraction {
    bool supports = false;  ///< pieces without samples go
    bool looks = false;     ///< counts what may be wrong
  };

  void extract(const BlockRange& own, const Spool& field, const Extraction& what, BlockMeshes& meshes) {
    BlockSamples block = read_weighed(own, plan_.around_finer_nodes(own));
    const OctreeData tree = build(block);
    poisson::Density density;
    if (what.supports || options_.density_face > 0) density = density_of(tree, block.samples);
    const poisson::Resolution resolution = resolution_of(tree, block.samples);
    const std::vector<std::int64_t> chosen =
        chosen_own(own, diagnose::kSamples / diagnose::kSparse, block.first_own, [](std::int64_t) { return true; });
    poisson::Samples looked_at;
    looked_at.positions = choose(chosen, block.samples.positions.cview());
    looked_at.splat_depths = choose(chosen, block.samples.splat_depths.cview());
    block = {};
    const OctreeView view = resolution.view(tree);
    exec::Buffer<float> u = read_field(view, field);
    surface::SurfacePlaces places;
    surface::ExtractOptions extraction{options_.curvature, options_.normals};
    extraction.places = &places;
    extraction.counted = {own.begin, own.end};
    field::FieldView function{view, u.data(), static_cast<float>(report_.isovalue),
                              options_.domain_faces == DomainFaces::closed,
                              resolution.bricks.empty() ? nullptr : resolution.bricks.data()};
    if (what.looks) diagnose::look_at_field_of_block(ex_, function, looked_at.view(), own.begin, own.end, counts_);
    if (options_.isovalue) function.isovalue = static_cast<float>(*options_.isovalue);
    const surface::Surface surface = surface::extract_surface(ex_, function, extraction);
    if (what.looks) report_.lone_corners += surface.lone_corners;
    exec::Buffer<float> per_cube, per_world;  // samples per area of the cube's unit, and of the world's
    if (what.supports) per_cube = density_at(tree, density, surface, std::ldexp(1.0, -2 * depth_));
    if (options_.density_face > 0) per_world = density_at(tree, density, surface, options_.density_face);
    std::vector<const std::byte*> columns{reinterpret_cast<const std::byte*>(surface.positions.data())};
    if (options_.normals) columns.push_back(reinterpret_cast<const std::byte*>(surface.normals.data()));
    if (options_.density_face > 0) columns.push_back(reinterpret_cast<const std::byte*>(per_world.data()));
    const auto span = [](const auto& buffer) {
      return std::span(buffer.data(), static_cast<std::size_t>(buffer.size()));
    };
    meshes.add({own.begin, own.end, span(places.keys), columns, span(surface.triangles), span(places.cells),
                span(places.segments), span(per_cube)});
  }

  /// As the whole has it, at nodes around which all samples are there.
  poisson::Density density_of(const OctreeData& tree, const Samples& samples) {
    poisson::Density density = poisson::splat_density(ex_, tree, samples.positions.cview());
    give(coarse_->counts(), density.counts);
    return density;
  }

  /// Samples per area.
  /// @param face  area of a face of a finest cell
  exec::Buffer<float> density_at(const OctreeData& tree, const poisson::Density& density,
                                 const surface::Surface& surface, double face) {
    auto values = exec::make_buffer<float>(ex_, surface.positions.size());
    poisson::evaluate_density(ex_, tree, density, surface.positions.cview(), values.view());
    for_each(ex_, "scale.density", values.size(), poisson::PerArea{face, values.view()});
    return values;
  }

  exec::Cpu& ex_;
  const SortedCloud& cloud_;
  const BlockOptions& options_;
  BlockReport& report_;
  int depth_;
  BlockPlan plan_;
  SampleValues values_;
  exec::Buffer<diagnose::Counts> counts_;
  std::optional<CoarseLevels> coarse_;
};

}  // namespace

BlockMeshes reconstruct_blocks(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options,
                               BlockReport& report) {
  const bool has_levels = options.coarse_level == 0 ||
                          (options.coarse_level >= octree::kCompleteDepth && options.coarse_level <= options.depth - 2);
  const bool plans = options.coarse_level == 0 || options.blocks == 0;
  if (!has_levels || options.depth - 2 < octree::kCompleteDepth || options.blocks < 0 || options.part_samples < 1 ||
      (plans && options.memory_bytes < 1))
    throw Error(ErrorCode::usage,
                fmt::format("a run in blocks needs a depth of at least {}, a coarse level from {} to two "
                            "above the depth, blocks, and parts that hold samples",
                            octree::kCompleteDepth + 2, octree::kCompleteDepth));
  return BlockRun(ex, cloud, options, report).run();
}

}  // namespace pointskin::scale
