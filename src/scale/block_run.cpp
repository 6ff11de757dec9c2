#include "scale/block_run.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/announce.hpp"
#include "core/format.hpp"
#include "diagnose/verdict.hpp"
#include "exec/cpu_primitives.hpp"
#include "exec/exact_sum.hpp"
#include "field/attributes.hpp"
#include "octree/keys.hpp"
#include "octree/view.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/spacing.hpp"
#include "reconstruct/mesh_of_field.hpp"
#include "reconstruct/pieces_by_support.hpp"
#include "reconstruct/trim_to_samples.hpp"
#include "scale/block_looks.hpp"
#include "scale/block_plan.hpp"
#include "scale/block_trim.hpp"
#include "scale/block_work.hpp"
#include "scale/coarse_levels.hpp"
#include "scale/examine_samples.hpp"
#include "scale/key_index.hpp"
#include "scale/kth_value.hpp"
#include "scale/sample_values.hpp"
#include "scale/spool.hpp"

namespace pointskin::scale {
namespace {

/// Limits what buffers may take together as long as it is there; 0: they may take what they like.
class LimitOfPool {
 public:
  LimitOfPool(exec::MemoryPool& pool, std::int64_t bytes) : pool_(pool) { pool_.set_limit(bytes); }
  ~LimitOfPool() { pool_.set_limit(0); }
  LimitOfPool(const LimitOfPool&) = delete;
  LimitOfPool& operator=(const LimitOfPool&) = delete;

 private:
  exec::MemoryPool& pool_;
};

/// Channels of the cloud's attributes that share each pass: neighbouring ones of which all samples have a value. Labels are none.
std::vector<std::size_t> passes_of(const SortedCloud& cloud) {
  std::vector<std::size_t> passes;
  bool joins = false;
  for (const PointAttribute& attribute : cloud.attributes()) {
    if (attribute.is_label()) continue;
    const bool has_all = attribute.range.counted == cloud.size();
    if (has_all && joins && passes.back() < field::kAttributesAtOnce)
      ++passes.back();
    else
      passes.push_back(1);
    joins = has_all;
  }
  return passes;
}

/// That a vertex has in the cloud's attributes.
std::int64_t attribute_bytes(const SortedCloud& cloud) {
  std::int64_t bytes = 0;
  for (const PointAttribute& attribute : cloud.attributes())
    bytes += static_cast<std::int64_t>(size_of(attribute.type));
  return bytes;
}

bool has_labels(const SortedCloud& cloud) {
  return std::ranges::any_of(cloud.attributes(), [](const PointAttribute& attribute) { return attribute.is_label(); });
}

/// That a block has of a sample for its attributes.
std::int64_t floats_of_sample(const SortedCloud& cloud, bool confidence) {
  constexpr std::int64_t kFloat = sizeof(float);
  std::int64_t floats = 0;
  bool has_channels = false;
  for (const PointAttribute& attribute : cloud.attributes()) {
    const auto bytes = static_cast<std::int64_t>(size_of(attribute.type));
    floats += attribute.is_label() ? (bytes + kFloat - 1) / kFloat : 1;
    has_channels = has_channels || !attribute.is_label();
  }
  return floats + (confidence && has_channels ? 1 : 0);
}

/// The place of the nearest sample of a vertex, and its distance.
constexpr std::int64_t kOfNearest = sizeof(std::int32_t) + sizeof(float);

BlockPlan::Setup plan_setup(const SortedCloud& cloud, const BlockOptions& options) {
  BlockPlan::Setup setup;
  setup.depth = options.depth;
  setup.coarse_level = options.coarse_level;
  setup.blocks = options.blocks;
  setup.memory_bytes = options.memory_bytes;
  setup.part_samples = options.part_samples;
  setup.iterations = options.iterations;
  setup.ring = options.ring;
  setup.lowest_splat_depth = poisson::coarsest_splat_depth(cloud.size(), options.depth);
  setup.sample_floats = floats_of_sample(cloud, options.confidence);
  setup.vertex_bytes = attribute_bytes(cloud) + (has_labels(cloud) ? kOfNearest : 0);
  setup.team = options.team;
  for (const std::size_t channels : passes_of(cloud)) {
    const auto floats = static_cast<std::int64_t>(1 + channels);
    setup.pass_floats = std::max(setup.pass_floats, floats);
    setup.coarse_floats += floats;
  }
  return setup;
}

class BlockRun {
 public:
  BlockRun(SharedOfBlocks& shared, BlockWork& work)
      : ex_(shared.host),
        shared_(shared),
        work_(work),
        cloud_(shared.cloud),
        options_(shared.options),
        team_(shared.options.team),
        report_(shared.report),
        depth_(shared.options.depth),
        plan_(shared.plan),
        values_(shared.values) {}

  BlockMeshes run() {
    sweep({"bricks", "octree", 0.03}, [&] { plan_.find_bricks(); });
    sweep({"plan", "octree", 0.04}, [&] {
      plan_.divide();
      shared_.coarse.emplace(ex_, plan_,
                             CoarseLevels::Setup{options_.screening, options_.iterations, options_.boundary,
                                                 picks_by_support() || options_.trim != 0 || options_.density_face > 0,
                                                 shared_.passes, team_});
      report_.blocks = static_cast<int>(plan_.blocks().size());
      report_.coarse_level = plan_.level();
      report_.coarse_nodes = coarse().nodes();
    });
    const LimitOfPool limit(work_.pool(), options_.holds_to_memory ? options_.memory_bytes : 0);
    over_blocks({"sums", "splat", 0.06, 0.1}, [&](const BlockRange& own) { work_.sum_facing(own); });
    coarse().finish_facing();
    over_blocks({"weights", "splat", 0.1, 0.15}, [&](const BlockRange& own) { work_.weigh(own); });
    coarse().drop_facing();
    sweep({"examine", "splat", 0.15}, [&] {
      const ExaminedSamples found = examine_samples(ex_, cloud_, options_, values_);
      shared_.mean_length = found.mean_length;
      counts_.sums[diagnose::kLonely] += found.lonely;
      report_.inliers = found.inliers;
    });
    over_blocks({"depths", "splat", 0.16, 0.19}, [&](const BlockRange& own) { work_.even_out(own); });
    const KeyIndex index(cloud_, plan_.level(), plan_.cells(), plan_.first());
    sweep({"look at samples", "splat", 0.19}, [&] { look_at_pairs(ex_, cloud_, values_, index, depth_, counts_); });
    if (options_.trim != 0) sweep({"trim limit", "splat", 0.19}, [&] { settle_trim(); });
    sweep({"coarse field", "splat", 0.19}, [&] { coarse().splat(); });
    over_blocks({"splat", "splat", 0.19, 0.36}, [&](const BlockRange& own) { work_.splat(own); });
    sweep({"coarse solve", "solve", 0.36}, [&] {
      coarse().finish_channels();
      solve_coarse();
    });
    poisson::ValuesOfSamples values;
    std::vector<std::unique_ptr<Spool>> fields(plan_.blocks().size());  // of own blocks
    over_blocks({"solve", "solve", 0.36, 0.8},
                [&](const BlockRange& own) { fields[own.number] = work_.solve(own, values); });
    report_.isovalue = mean_of(joined(values), fields);
    join_levels();
    BlockMeshes meshes = extract_all(fields);
    sweep({"look at triangles", "extract", 0.98}, [&] { look_at(meshes); });
    report_.looks = looks();
    return meshes;
  }

 private:
  /// A pass over all samples or blocks.
  struct Pass {
    const char* name;   ///< in the report
    const char* phase;  ///< as callers of Options::progress know it
    double begin;       ///< of the run that is done then
    double end = 1;     ///< of a pass over blocks
  };

  [[nodiscard]] CoarseLevels& coarse() { return *shared_.coarse; }

  [[nodiscard]] bool trims() const { return report_.trim > 0; }
  [[nodiscard]] bool chooses_trim() const { return options_.trim == Options::kAutomaticTrim; }

  /// As detail::fit_field() settles it.
  void settle_trim() {
    report_.trim = chooses_trim() ? diagnose::fitting_trim(diagnose::findings_of(looks())) : options_.trim;
    if (!trims()) return;
    const std::int64_t place = poisson::place_of_sparsest(cloud_.size(), report_.trim);
    report_.trim_limit = detail::kTrimSpacing * kth_value(values_, SampleValues::spacing, place, options_.part_samples);
  }

  [[nodiscard]] MeshColumns columns() const {
    MeshColumns columns;
    const auto add = [&](std::size_t& place, std::int64_t bytes) {
      place = columns.bytes.size();
      columns.bytes.push_back(bytes);
    };
    if (options_.normals) add(columns.normals, sizeof(Vec3f));
    if (options_.density_face > 0) add(columns.density, sizeof(float));
    if (!cloud_.attributes().empty()) columns.attributes = columns.bytes.size();
    for (const PointAttribute& attribute : cloud_.attributes())
      columns.bytes.push_back(static_cast<std::int64_t>(size_of(attribute.type)));
    if (!trims()) return columns;
    if (!options_.normals) add(columns.normals, sizeof(Vec3f));
    add(columns.spacing, sizeof(float));
    if (picks_by_support()) add(columns.supports, sizeof(float));
    return columns;
  }

  [[nodiscard]] bool picks_by_support() const {
    return detail::picks_pieces_by_support(options_.largest, options_.min_component);
  }
  [[nodiscard]] double fewest_samples() {
    if (!picks_by_support()) return 0;
    return detail::fewest_samples(diagnose::findings_of(looks()).lonely > 0, report_.lone_corners);
  }

  [[nodiscard]] surface::PieceOptions pieces_that_stay() {
    return {options_.largest, options_.min_component, fewest_samples()};
  }
  static bool looks_for_pieces(const surface::PieceOptions& pieces) {
    return pieces.largest || pieces.least > 0 || pieces.least_samples > 0;
  }

  /// Whether pieces without samples go, and whether the surface is open at the faces of the cube, may be known once all is
  /// extracted: then once more.
  BlockMeshes extract_all(std::vector<std::unique_ptr<Spool>>& fields) {
    shared_.columns = columns();
    surface::PieceOptions pieces = pieces_that_stay();
    const bool waits_for_pieces = !trims() && picks_by_support() && !looks_for_pieces(pieces);
    const bool waits_for_faces = chooses_trim() && options_.domain_faces == DomainFaces::closed;
    BlockWork::Extraction what{trims() ? picks_by_support() : pieces.least_samples > 0, true, options_.domain_faces};
    BlockMeshes meshes = extract_once({"extract", "extract", 0.8, 0.98}, what, !trims() && looks_for_pieces(pieces),
                                      fields, !waits_for_pieces && !waits_for_faces);
    what.looks = false;
    if (waits_for_faces && diagnose::runs_into_faces(diagnose::findings_of(looks()))) {
      what.faces = DomainFaces::open;
      meshes = extract_once({"extract open", "extract", 0.98, 0.98}, what, !trims() && looks_for_pieces(pieces), fields,
                            !waits_for_pieces);
    }
    pieces = pieces_that_stay();
    if (waits_for_pieces && looks_for_pieces(pieces)) {
      what.supports = true;
      meshes = extract_once({"extract again", "extract", 0.98, 0.98}, what, true, fields, true);
    }
    fields.clear();
    sweep({"join", "extract", 0.98}, [&] { meshes.finish(); });
    if (trims() && meshes.triangles() > 0) trim(meshes, looks_for_pieces(pieces));
    sweep({"pieces", "extract", 0.98}, [&] {
      if (looks_for_pieces(pieces) && meshes.triangles() > 0) report_.pieces = meshes.keep_pieces(pieces);
    });
    return meshes;
  }

  /// @param last  nobody needs the fields after this
  BlockMeshes extract_once(const Pass& pass, const BlockWork::Extraction& what, bool pieces,
                           std::vector<std::unique_ptr<Spool>>& fields, bool last) {
    BlockMeshes meshes({options_.folder, depth_, plan_.level(), shared_.columns.bytes, pieces, team_});
    report_.lone_corners = 0;
    over_blocks(pass, [&](const BlockRange& own) {
      work_.extract(own, *fields[own.number], what, meshes);
      if (last) fields[own.number].reset();
    });
    report_.lone_corners = team_.reduce(report_.lone_corners, std::plus<>{});
    return meshes;
  }

  /// As detail::extract() does.
  void trim(BlockMeshes& meshes, bool pieces) {
    const MeshColumns& columns = shared_.columns;
    const CutColumns from{0, columns.normals, columns.spacing};
    const std::optional<std::size_t> supports =
        columns.supports == MeshColumns::kNone ? std::nullopt : std::optional(columns.supports);
    if (!is_worth_trimming(meshes)) {
      report_.trim = 0;
      if (pieces) meshes.cut(ex_, BlockCut::of_nothing(meshes, from), pieces, supports);
      return;
    }
    BlockCut cut;
    sweep({"trim", "extract", 0.98}, [&] {
      cut = find_cut(meshes, from, {report_.trim_limit, options_.island_ratio}, report_.cut);
    });
    std::vector<double> faces;
    std::vector<std::size_t> densities;
    const auto add = [&](bool needs, std::size_t column, double face) {
      if (!needs) return;
      densities.push_back(column);
      faces.push_back(face);
    };
    add(columns.density != MeshColumns::kNone, columns.density, options_.density_face);
    add(pieces && supports, columns.supports, std::ldexp(1.0, -2 * depth_));
    if (!cut.edges.empty()) find_values_on_line(faces, densities, cut);
    sweep({"cut", "extract", 0.98}, [&] { meshes.cut(ex_, cut, pieces, supports); });
  }

  /// Densities and attributes of the vertices on the line.
  /// @param densities  columns, of each of `faces`
  void find_values_on_line(const std::vector<double>& faces, const std::vector<std::size_t>& densities, BlockCut& cut) {
    const MeshColumns& columns = shared_.columns;
    const std::size_t attributes = cloud_.attributes().size();
    if (faces.empty() && attributes == 0) return;
    const auto bytes_of = [&](std::size_t column) { return static_cast<std::size_t>(columns.bytes[column]); };
    cut.others.resize(columns.bytes.size());
    const auto make_room = [&](std::size_t column) { cut.others[column].resize(cut.edges.size() * bytes_of(column)); };
    for (const std::size_t column : densities) make_room(column);
    for (std::size_t i = 0; i < attributes; ++i) make_room(columns.attributes + i);
    std::vector<PlaceOnLine> places;
    for (const Vec3f& p : cut.positions)
      places.push_back({octree::cell_key(octree::point_key(p.x, p.y, p.z), depth_), places.size()});
    std::ranges::sort(places, {}, [](const PlaceOnLine& place) { return std::pair(place.cell, place.vertex); });
    over_blocks({"values of the cut", "extract", 0.98, 0.98}, [&](const BlockRange& own) {
      const std::span<const PlaceOnLine> here = places_in(own, places);
      if (here.empty()) return;
      std::vector<Vec3f> points;
      std::ranges::transform(here, std::back_inserter(points),
                             [&](const PlaceOnLine& place) { return cut.positions[place.vertex]; });
      const BlockWork::PointValues found = work_.values_at(own, points, faces);
      const auto put = [&](std::size_t column, const void* values) {
        put_values(static_cast<const std::byte*>(values), bytes_of(column), here, cut.others[column]);
      };
      for (std::size_t i = 0; i < faces.size(); ++i) put(densities[i], found.densities[i].data());
      for (std::size_t i = 0; i < attributes; ++i) put(columns.attributes + i, found.attributes[i].data());
    });
    if (team_.is_alone()) return;
    for (std::size_t column = 0; column < cut.others.size(); ++column)
      if (!cut.others[column].empty()) join_values_on_line(places, bytes_of(column), cut.others[column]);
  }

  /// A vertex on the line of a cut, by the cell of the finest level that it lies in.
  struct PlaceOnLine {
    std::uint64_t cell = 0;
    std::size_t vertex = 0;
  };
  /// @param places  by their cells
  static std::span<const PlaceOnLine> places_in(const BlockRange& own, std::span<const PlaceOnLine> places) {
    const auto begin_of = [&](std::uint64_t cell) {
      return std::ranges::lower_bound(places, cell, {}, &PlaceOnLine::cell) - places.begin();
    };
    const std::ptrdiff_t begin = begin_of(own.begin), end = begin_of(own.end);
    return places.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  }
  /// @param from  (places) values of `bytes` each
  /// @param to    of all vertices on the line
  static void put_values(const std::byte* from, std::size_t bytes, std::span<const PlaceOnLine> places,
                         std::vector<std::byte>& to) {
    for (std::size_t i = 0; i < places.size(); ++i) std::memcpy(&to[places[i].vertex * bytes], from + i * bytes, bytes);
  }
  /// Those that the blocks of other ranks have found.
  void join_values_on_line(std::span<const PlaceOnLine> places, std::size_t bytes, std::vector<std::byte>& values) {
    std::vector<std::byte> own;
    for (const PlaceOnLine& place : places_in(plan_.range_of(team_.rank()), places))
      own.insert(own.end(), &values[place.vertex * bytes], &values[place.vertex * bytes] + bytes);
    const std::vector<std::vector<std::byte>> all = team_.gather(std::move(own));
    for (int rank = 0; rank < team_.size(); ++rank)
      put_values(all[static_cast<std::size_t>(rank)].data(), bytes, places_in(plan_.range_of(rank), places), values);
  }

  /// As detail::extract() has it.
  bool is_worth_trimming(const BlockMeshes& meshes) {
    if (!chooses_trim() || detail::is_cut_by_faces(diagnose::findings_of(looks()))) return true;
    sweep({"look at what may be cut", "extract", 0.98}, [&] { look_at(meshes); });
    return diagnose::findings_of(looks()).far >= detail::kLittleFar;
  }

  void look_at(const BlockMeshes& meshes) {
    const KeyIndex index(cloud_, plan_.level(), plan_.cells(), plan_.first());
    look_at_triangles(meshes, index, diagnose::far_depth(diagnose::findings_of(looks()), depth_), counts_);
  }

  /// What has been counted so far.
  [[nodiscard]] diagnose::Counts looks() {
    diagnose::Counts all = team_.reduce(work_.looks(), [](diagnose::Counts a, const diagnose::Counts& b) {
      diagnose::add(a, b);
      return a;
    });
    diagnose::add(all, counts_);
    return all;
  }

  template <class Work>
  void sweep(const Pass& pass, const Work& work) {
    announce(options_.progress, pass.phase, pass.begin);
    ex_.pool()->trim();  // what another pass left, in other sizes, is no use
    work_.pool().trim();
    const auto begin = std::chrono::steady_clock::now();
    work();
    report_.sweeps.push_back(
        {pass.name, pass.phase, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
  }
  /// Calls work(block) for this rank's blocks.
  template <class Work>
  void over_blocks(const Pass& pass, const Work& work) {
    sweep(pass, [&] {
      const Team::Share own = team_.share_of(std::ssize(plan_.blocks()));
      team_.together([&] {
        for (std::int64_t i = own.begin; i < own.end; ++i) {
          const double share = static_cast<double>(i - own.begin) / static_cast<double>(own.end - own.begin);
          announce(options_.progress, pass.phase, pass.begin + share * (pass.end - pass.begin));
          work(plan_.blocks()[static_cast<std::size_t>(i)]);
        }
      });
    });
  }

  [[nodiscard]] poisson::ValuesOfSamples joined(const poisson::ValuesOfSamples& own) const {
    return team_.reduce(own, [](poisson::ValuesOfSamples a, const poisson::ValuesOfSamples& b) {
      a.add(b);
      return a;
    });
  }

  /// Levels below the coarse ones have nodes of every rank.
  void join_levels() {
    struct Own {
      int depth, iterations;
      std::int64_t nodes;
    };
    std::vector<LevelReport>& levels = report_.levels;
    const auto coarse_levels = std::min(std::ssize(levels), std::ptrdiff_t{plan_.level()} + 1);
    std::vector<Own> own;
    for (auto level = levels.begin() + coarse_levels; level != levels.end(); ++level)
      own.push_back({level->depth, level->iterations, level->nodes});
    levels.resize(static_cast<std::size_t>(coarse_levels));
    for (const Own& found : team_.gather_all(std::move(own))) {
      const auto place = static_cast<std::size_t>(found.depth);
      if (levels.size() <= place) levels.push_back({found.depth, 0, 0, found.iterations, 0, 0});
      levels[place].nodes += found.nodes;
    }
    const auto larger = [](std::int64_t a, std::int64_t b) { return std::max(a, b); };
    report_.most_samples = team_.reduce(report_.most_samples, larger);
    report_.most_nodes = team_.reduce(report_.most_nodes, larger);
  }

  void solve_coarse() {
    for (const poisson::LevelSolve& level : coarse().solve())
      report_.levels.push_back(
          {level.depth, coarse().tree().view().levels[level.depth].cells(), 0, level.iterations, 0, 0});
  }

  /// As poisson::mean_at_samples() has it: values that are far from 1/2 are summed up once more, in another unit.
  double mean_of(const poisson::ValuesOfSamples& values, const std::vector<std::unique_ptr<Spool>>& fields) {
    if (values.reliable()) return values.mean(poisson::ValuesOfSamples::kFraction);
    if (!std::isfinite(values.largest)) return std::numeric_limits<double>::quiet_NaN();
    if (values.largest == 0) return 0;
    const int fraction = exec::fraction_for(values.largest);
    poisson::ValuesOfSamples again;
    over_blocks({"sum again", "solve", 0.8, 0.8},
                [&](const BlockRange& own) { again.add(work_.sum_values(own, *fields[own.number], fraction)); });
    return joined(again).mean(fraction);
  }

  exec::Cpu& ex_;
  SharedOfBlocks& shared_;
  BlockWork& work_;
  const SortedCloud& cloud_;
  const BlockOptions& options_;
  const Team& team_;
  BlockReport& report_;
  int depth_;
  BlockPlan& plan_;
  SampleValues& values_;
  diagnose::Counts counts_{};  ///< of what needs no block
};

void check_options(const BlockOptions& options) {
  const bool has_levels = options.coarse_level == 0 ||
                          (options.coarse_level >= octree::kCompleteDepth && options.coarse_level <= options.depth - 2);
  const bool plans = options.coarse_level == 0 || options.blocks == 0;
  if (!has_levels || options.depth - 2 < octree::kCompleteDepth || options.blocks < 0 || options.part_samples < 1 ||
      (plans && options.memory_bytes < 1))
    throw Error(ErrorCode::usage,
                fmt::format("a run in blocks needs a depth of at least {}, a coarse level from {} to two "
                            "above the depth, blocks, and parts that hold samples",
                            octree::kCompleteDepth + 2, octree::kCompleteDepth));
}

}  // namespace

BlockOptions block_options_of(const Options& options, const octree::Frame& cube) {
  BlockOptions blocks;
  blocks.depth = options.depth;
  blocks.samples_per_node = options.samples_per_node;
  blocks.screening = options.screening;
  blocks.fixed_screening = options.fixed_screening;
  blocks.confidence = options.confidence;
  blocks.iterations = options.iterations;
  blocks.curvature = options.linear_fit ? 0 : detail::kCurvature;
  blocks.normals = options.normals;
  blocks.boundary = options.boundary;
  blocks.domain_faces = options.domain_faces;
  blocks.isovalue = options.isovalue;
  blocks.largest = options.largest;
  blocks.min_component = options.min_component;
  blocks.trim = options.trim;
  blocks.island_ratio = options.island_ratio;
  const double cell = cube.size / static_cast<double>(std::int64_t{1} << options.depth);
  if (options.density) blocks.density_face = cell * cell;
  blocks.progress = options.progress;
  return blocks;
}

BlockEstimate estimate_blocks(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options) {
  const int passes = options.trim == 0 ? 6 : 7;
  const std::int64_t meshes = options.trim == 0 ? 1 : 2;  // the one that is cut, and what is left
  constexpr std::int64_t kMesh = 6;   // bytes a node: 0.26 triangles for a sphere, half as many vertices with normals
  constexpr double kVertices = 0.13;  // a node
  check_options(options);
  BlockPlan plan(ex, cloud, plan_setup(cloud, options));
  plan.find_bricks();
  plan.divide();
  const BlockPlan::Sizes sizes = plan.sizes();
  const std::int64_t values = SampleValues::columns(options.trim != 0) * cloud.size() + sizes.nodes;
  const auto attributes =
      static_cast<std::int64_t>(kVertices * static_cast<double>(attribute_bytes(cloud) * meshes * sizes.own_nodes));
  return {static_cast<int>(plan.blocks().size()),
          plan.level(),
          plan.ring(),
          passes,
          sizes.nodes,
          sizes.own_nodes,
          sizes.largest_bytes,
          values * std::int64_t{sizeof(float)} + meshes * kMesh * sizes.own_nodes + attributes};
}

BlockMeshes reconstruct_blocks(const MakeBlockWork& make, exec::Cpu& host, const SortedCloud& cloud,
                               const BlockOptions& options, BlockReport& report) {
  check_options(options);
  SharedOfBlocks shared{host,
                        cloud,
                        options,
                        report,
                        {host, cloud, plan_setup(cloud, options)},
                        {options.team, options.folder, cloud.size(), options.trim != 0},
                        passes_of(cloud)};
  const std::unique_ptr<BlockWork> work = make(shared);
  return BlockRun(shared, *work).run();
}

BlockMeshes reconstruct_blocks(exec::Cpu& ex, const SortedCloud& cloud, const BlockOptions& options,
                               BlockReport& report) {
  return reconstruct_blocks([&](SharedOfBlocks& shared) { return make_block_work(ex, shared); }, ex, cloud, options,
                            report);
}

BlockMeshes reconstruct_blocks(const exec::AnySpace& space, exec::Cpu& host, const SortedCloud& cloud,
                               const BlockOptions& options, BlockReport& report) {
  return exec::visit(space, [&](auto& ex) {
    return reconstruct_blocks([&](SharedOfBlocks& shared) { return make_block_work(ex, shared); }, host, cloud, options,
                              report);
  });
}

}  // namespace pointskin::scale
