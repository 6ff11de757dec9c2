#include <pointskin/error.hpp>
#include <pointskin/scale.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/announce.hpp"
#include "core/format.hpp"
#include "diagnose/verdict.hpp"
#include "diagnose/warnings.hpp"
#include "exec/any_space.hpp"
#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "io/source.hpp"
#include "octree/frame.hpp"
#include "reconstruct/coordinate_step.hpp"
#include "reconstruct/fit_cube.hpp"
#include "reconstruct/kept_names.hpp"
#include "reconstruct/mesh_of_field.hpp"
#include "reconstruct/trim_to_samples.hpp"
#include "scale/block_run.hpp"
#include "scale/cloud_extent.hpp"
#include "scale/sorted_cloud.hpp"
#include "scale/team.hpp"
#include "scale/write_blocks.hpp"

namespace pointskin {
namespace {

using diagnose::NormalsVerdict;

scale::KeptAttributes kept_attributes(const Options& options, const ScaleOptions& scale) {
  if (!options.attributes) return scale::KeptAttributes::none;
  return scale.only_colours ? scale::KeptAttributes::colours : scale::KeptAttributes::all;
}

/// What of the attributes that are to be kept cannot be, in words; empty if all can.
std::string missing_attributes(const std::vector<std::string>& inputs, const Options& options,
                               const ScaleOptions& scale) {
  if (!options.attributes) return "";
  exec::Cpu ex(scale.threads);
  const std::unique_ptr<io::CloudParts> points = io::CloudParts::open(ex, inputs);
  if (points == nullptr) return "";
  const std::vector<std::string> with_gaps = points->integers_with_gaps(ex);
  for (const scale::PointAttribute& attribute : scale::attributes_of(ex, *points, kept_attributes(options, scale)))
    if (std::find(with_gaps.begin(), with_gaps.end(), attribute.name) != with_gaps.end())
      return "integers that not all files have, such as " + io::printable(attribute.name);
  return "";
}

std::unique_ptr<io::CloudParts> open_parts(exec::Cpu& ex, const std::vector<std::string>& inputs) {
  std::unique_ptr<io::CloudParts> parts = io::CloudParts::open(ex, inputs);
  if (parts != nullptr) return parts;
  const auto not_in_parts =
      std::find_if_not(inputs.begin(), inputs.end(), [](const std::string& input) { return reads_in_parts(input); });
  throw Error(ErrorCode::invalid_input,
              fmt::format("{}: cannot be read in parts; blocks need text, or binary PLY or NPY files whose rows are of "
                          "one length",
                          io::printable(not_in_parts == inputs.end() ? inputs.front() : *not_in_parts)));
}

/// What a fit of the cloud found, and the mesh.
struct Fit {
  scale::BlockReport report;
  std::vector<scale::PointAttribute> attributes;
  std::vector<std::string> without_values;  ///< names of attributes
  std::optional<scale::BlockMeshes> meshes;
};

/// The points that are left out, and the cube around the others.
struct Place {
  octree::StrayPoints left_out;  // indices ascend
  octree::Frame frame;
};

class FilesRun {
 public:
  FilesRun(const std::vector<std::string>& inputs, const Options& options, const ScaleOptions& scale)
      : options_(options), scale_(scale), team_(scale.ranks), ex_(scale.threads), parts_(open_parts(ex_, inputs)) {
    if (scale_.device.kind != DeviceKind::cpu) gpu_.emplace(scale_.device);
    if (scale_.temp_folder.empty()) scale_.temp_folder = std::filesystem::temp_directory_path().string();
    bytes_ = team_.reduce(bytes(), [](std::int64_t a, std::int64_t b) { return std::min(a, b); });
  }

  FilesPlan plan() {
    place_cloud();
    const scale::SortedCloud cloud = sorted();
    const scale::BlockEstimate blocks = scale::estimate_blocks(ex_, cloud, block_options());
    FilesPlan plan;
    plan.points = cloud.size();
    plan.blocks = blocks.blocks;
    plan.coarse_level = blocks.coarse_level;
    plan.ring = blocks.ring;
    plan.overlap = static_cast<double>(blocks.nodes) / static_cast<double>(blocks.own_nodes);
    plan.passes = blocks.passes;
    plan.memory_bytes = blocks.memory_bytes;
    plan.temp_bytes = std::max(2 * cloud.bytes(), cloud.bytes() + blocks.temporary_bytes);
    return plan;
  }

  FilesReport run(const std::string& output) {
    place_cloud();
    Fit fit = fit_cloud();
    const auto judge = [&] { return judge_normals(fit); };
    if (options_.point_normals == PointNormals::automatic && judge() == NormalsVerdict::inside_out) {
      fit = {};
      turned_ = true;
      fit = fit_cloud();
      result_.run.normals_done = NormalsDone::turned;
      diagnose::warn_of_turning(result_.run.warnings);
    } else if (judge() != NormalsVerdict::inside_out || options_.trim != Options::kAutomaticTrim) {
      diagnose::warn_of_normals(findings(fit), judge(), result_.run.warnings);
    }
    warn(fit);
    announce(options_.progress, "write", 0.99);
    const scale::VertexColumns columns = vertex_columns(fit);
    for (const auto& attribute : columns.attributes) result_.attributes.push_back(attribute.name);
    write(fit, columns, output);
    report(fit);
    return std::move(result_);
  }

 private:
  static diagnose::Findings findings(const Fit& fit) { return diagnose::findings_of(fit.report.looks); }

  [[nodiscard]] NormalsVerdict judge_normals(const Fit& fit) const {
    return diagnose::judge_normals(findings(fit), options_.boundary == Boundary::free);
  }

  void write(const Fit& fit, const scale::VertexColumns& columns, const std::string& output) {
    result_.outputs = {output};
    if (scale_.split)
      result_.outputs =
          scale::write_split_ply(ex_, *fit.meshes, columns, place_.frame, parts_->origin(), output, team_);
    else
      scale::write_ply(ex_, *fit.meshes, columns, place_.frame, parts_->origin(), output, team_);
  }

  void place_cloud() {
    announce(options_.progress, "octree", 0);
    parts_->choose_origin(ex_, scale_.shift);
    parts_->leave_out_zero_normals();
    scale::CloudExtent extent = scale::find_extent(ex_, *parts_, options_.keep_strays, team_);
    before_ = extent.before;
    result_.dropped = extent.dropped;
    result_.without_normal = parts_->rows() - extent.dropped - extent.points - extent.strays.size();
    set_place(std::move(extent.strays), octree::frame_around(extent.strays.core, options_.scale));
  }

  void set_place(octree::StrayPoints left_out, const octree::Frame& frame) {
    result_.run.farthest_strays.clear();
    detail::report_strays(left_out, result_.run);
    std::sort(left_out.indices.begin(), left_out.indices.end());
    place_ = {std::move(left_out), frame};
  }

  /// @throws Error empty_result if there is no surface
  Fit fit_cloud() {
    Fit fit = fit_around_inliers();
    const surface::PieceCounts& pieces = fit.report.pieces;
    result_.run.pieces = {pieces.pieces, pieces.pieces_removed, pieces.triangles_removed};
    result_.run.trim = {};
    if (fit.report.trim > 0) {
      result_.run.trim = detail::trim_report(fit.report.cut, place_.frame, options_.depth, fit.report.trim_limit);
      result_.run.trim.quantile = fit.report.trim;
    }
    detail::check_triangles(fit.meshes->triangles(), result_.run);
    return fit;
  }

  /// Where some samples are lonely, the cube is made for the others, and the fit begins again: once.
  Fit fit_around_inliers() {
    Fit fit = fit_in_cube();
    ++fits_;
    if (has_core_ || options_.keep_strays) return fit;
    const std::optional<Bounds> core = core_of(fit.report);
    if (!core) return fit;
    has_core_ = true;
    fit = {};
    const octree::Frame cube = octree::frame_around(*core, options_.scale);
    set_place(scale::find_outside(ex_, *parts_, cube, *core, team_, before_), cube);
    fit = fit_in_cube();
    ++fits_;
    return fit;
  }

  [[nodiscard]] std::optional<Bounds> core_of(const scale::BlockReport& report) const {
    if (diagnose::findings_of(report.looks).lonely <= 0 || report.inliers.is_empty) return std::nullopt;
    return detail::core_in(report.inliers.box, place_.frame, options_.scale);
  }

  [[nodiscard]] scale::SortedCloud sorted() {
    return {ex_,
            *parts_,
            {scale_.temp_folder, bytes_ / kSortShare, place_.frame, place_.left_out.indices, turned_,
             kept_attributes(options_, scale_), team_, before_}};
  }

  [[nodiscard]] scale::VertexColumns vertex_columns(const Fit& fit) const {
    scale::VertexColumns columns{options_.normals, options_.density};
    std::vector<std::string> names;
    for (const scale::PointAttribute& attribute : fit.attributes) names.push_back(attribute.name);
    names = detail::kept_names(names, options_.density, options_.weakness);
    for (std::size_t i = 0; i < names.size(); ++i) columns.attributes.push_back({names[i], fit.attributes[i].type});
    return columns;
  }

  Fit fit_in_cube() {
    constexpr int kTries = 4;
    scale::BlockOptions blocks = block_options();
    const scale::SortedCloud cloud = sorted();
    points_ = cloud.size();
    for (int tries = 1;; ++tries) {
      Fit fit{{}, cloud.attributes(), cloud.without_values(), {}};
      try {
        fit.meshes.emplace(gpu_ ? scale::reconstruct_blocks(*gpu_, ex_, cloud, blocks, fit.report)
                                : scale::reconstruct_blocks(ex_, cloud, blocks, fit.report));
        return fit;
      } catch (const Error& error) {  // of what was planned for
        if (error.code() != ErrorCode::over_limit || fit.report.blocks == 0 || tries == kTries) throw;
        if (!team_.is_alone() && dynamic_cast<const scale::FailedTogether*>(&error) == nullptr) throw;
        blocks.blocks = 2 * fit.report.blocks;
      }
    }
  }

  /// What lists of cells, threads and blocks of unlike sizes take beside what is planned: 4 to 6 MB measured.
  static constexpr std::int64_t kUnplanned = 6'000'000;

  /// Of the memory.
  static constexpr std::int64_t kSortShare = 8;

  [[nodiscard]] std::int64_t bytes() const {
    constexpr std::int64_t kAsMuchAsItLikes = std::int64_t{1} << 50;
    if (scale_.max_memory_bytes > 0) return scale_.max_memory_bytes;
    return gpu_ ? scale_.device.available_bytes() : kAsMuchAsItLikes;
  }

  [[nodiscard]] std::int64_t planned_bytes() const {
    return std::max<std::int64_t>(1, bytes_ - bytes_ / 32 - kUnplanned);
  }

  [[nodiscard]] scale::BlockOptions block_options() const {
    constexpr std::int64_t kFewestSamples = 1 << 14, kMostSamples = 1 << 22;  // of a part
    scale::BlockOptions blocks = scale::block_options_of(options_, place_.frame);
    blocks.folder = scale_.temp_folder;
    blocks.memory_bytes = planned_bytes();
    blocks.holds_to_memory = scale_.max_memory_bytes > 0;
    blocks.part_samples = std::clamp(bytes_ / 1000, kFewestSamples, kMostSamples);
    blocks.team = team_;
    return blocks;
  }

  void warn(const Fit& fit) {
    std::vector<Warning>& warnings = result_.run.warnings;
    diagnose::warn_of_strays(result_.run.strays, farthest(), warnings);
    diagnose::warn_of_attributes(fit.without_values, warnings);
    const diagnose::Findings found = findings(fit);
    const diagnose::Cube cube{place_.frame.size, options_.depth};
    diagnose::warn_of_fit(found, cube, warnings);
    if (found.spacing > 0) warn_of_digits(found.spacing * cube.cell(cube.depth));
    if (judge_normals(fit) != NormalsVerdict::inside_out) diagnose::warn_of_surface(found, cube, options_, warnings);
  }

  void warn_of_digits(double spacing) {
    const Vec3d& origin = parts_->origin();
    const auto are_floats = [&](std::size_t axis) {
      bool all = true;
      parts_->for_parts(ex_, [&](const Cloud& cloud) {
        all = all && std::all_of(cloud.positions.begin(), cloud.positions.end(), [&](const Vec3f& p) {
                return detail::is_float(origin[axis] + static_cast<double>(axis == 0 ? p.x : axis == 1 ? p.y : p.z));
              });
      });
      return all;
    };
    const double given = detail::coordinate_step(origin, place_.frame, diagnose::kHarmlessStep * spacing, are_floats);
    detail::warn_of_coordinates(origin, place_.frame, given, spacing, result_.run.warnings);
  }

  [[nodiscard]] std::vector<Vec3d> farthest() const {
    std::vector<Vec3d> places = result_.run.farthest_strays;
    for (Vec3d& p : places)
      for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += parts_->origin()[axis];
    return places;
  }

  void report(const Fit& fit) {
    RunReport& run = result_.run;
    run.farthest_strays = farthest();
    run.points = points_;
    run.fits = fits_;
    run.depth = options_.depth;
    run.levels = fit.report.levels;
    for (const LevelReport& level : run.levels) run.nodes += level.nodes;
    run.isovalue = fit.report.isovalue;
    run.device_peak_bytes = (gpu_ ? gpu_->pool() : ex_.pool())->peak_bytes();
    for (const scale::BlockReport::Sweep& sweep : fit.report.sweeps) time_of(sweep.phase) += 1000 * sweep.seconds;
    result_.vertices = fit.meshes->vertices();
    result_.triangles = fit.meshes->triangles();
    result_.blocks = fit.report.blocks;
    result_.coarse_level = fit.report.coarse_level;
  }
  double& time_of(const std::string& phase) {
    RunReport& run = result_.run;
    return phase == "octree"  ? run.octree_ms
           : phase == "splat" ? run.splat_ms
           : phase == "solve" ? run.solve_ms
                              : run.extract_ms;
  }

  Options options_;
  ScaleOptions scale_;
  scale::Team team_;
  exec::Cpu ex_;
  std::optional<exec::AnySpace> gpu_;
  std::unique_ptr<io::CloudParts> parts_;
  Place place_;
  FilesReport result_;
  std::int64_t bytes_ = 0;  ///< that every rank has
  std::int64_t points_ = 0;
  std::int64_t before_ = 0;  ///< points in the rows before this rank's
  int fits_ = 0;
  bool turned_ = false, has_core_ = false;
};

}  // namespace

bool reads_in_parts(const std::string& path) { return io::FileParts::can_open(path); }

std::vector<std::string> missing_in_blocks(const std::vector<std::string>& inputs, const Options& options,
                                           const ScaleOptions& scale) {
  std::vector<std::string> missing;
  const auto name = [&](bool asked, const char* what) {
    if (asked) missing.emplace_back(what);
  };
  name(options.depth == Options::kAutomaticDepth, "choosing the depth");
  name(options.point_normals == PointNormals::repair || options.point_normals == PointNormals::estimate,
       "making normals");
  name(options.field != FieldKind::poisson, "the distance field");
  name(options.envelope != nullptr, "an envelope");
  name(options.offset != 0, "an offset");
  name(options.weakness, "weakness");
  if (!inputs.empty())
    if (std::string attributes = missing_attributes(inputs, options, scale); !attributes.empty())
      missing.push_back(std::move(attributes));
  return missing;
}

namespace {

void check_request(const std::vector<std::string>& inputs, const Options& options, const ScaleOptions& scale) {
  validate(options);
  const std::vector<std::string> missing = missing_in_blocks(inputs, options, scale);
  if (!missing.empty())
    throw Error(ErrorCode::usage, fmt::format("in blocks there is not yet: {}", fmt::join(missing, ", ")));
}

}  // namespace

FilesPlan plan_files(const std::vector<std::string>& inputs, const Options& options, const ScaleOptions& scale) {
  check_request(inputs, options, scale);
  return FilesRun(inputs, options, scale).plan();
}

FilesReport reconstruct_files(const std::vector<std::string>& inputs, const std::string& output, const Options& options,
                              const ScaleOptions& scale) {
  check_request(inputs, options, scale);
  return FilesRun(inputs, options, scale).run(output);
}

}  // namespace pointskin
