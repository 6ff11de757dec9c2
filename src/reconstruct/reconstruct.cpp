#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "core/format.hpp"
#include "reconstruct/engine.hpp"
#include "reconstruct/many.hpp"
#include "reconstruct/run.hpp"
#include "reconstruct/suggest_depth.hpp"

namespace pointskin {
namespace {

void require(bool holds, const char* name, const char* range) {
  if (!holds) throw Error(ErrorCode::usage, fmt::format("option {} must be {}", name, range));
}

/// Options that contradict each other.
void check_combinations(const Options& options) {
  const auto exclude = [](bool both, const char* story) {
    if (both) throw Error(ErrorCode::usage, story);
  };
  const bool distance = options.field == FieldKind::distance;
  exclude(distance && options.envelope != nullptr, "option envelope needs the field poisson");
  exclude(distance && options.boundary == Boundary::dirichlet, "option boundary must be free with the field distance");
  exclude(distance && options.weakness, "option weakness needs the field poisson");
  exclude(options.envelope != nullptr && options.isovalue.value_or(1) <= 0,
          "inside an envelope the isovalue must be above 0: the field is 0 outside of it");
  if (options.offset == 0) return;
  exclude(options.isovalue.has_value(), "options offset and isovalue exclude each other");
  exclude(options.weakness, "options offset and weakness exclude each other: there are no samples on the surface");
  exclude(options.trim != 0, "options offset and trim exclude each other");
  exclude(options.density, "options offset and density exclude each other: there are no samples on the surface");
  exclude(options.attributes, "options offset and attributes exclude each other: there are no samples on the surface");
  exclude(options.envelope != nullptr, "options offset and envelope exclude each other");
  exclude(options.domain_faces == DomainFaces::open, "an offset surface is closed: domain_faces must be closed");
}

}  // namespace

class PSK_HIDDEN Reconstructor::Impl {
 public:
  explicit Impl(Workspace workspace) : engine_(std::move(workspace)) {}

  std::shared_ptr<detail::FieldImpl> solve(const detail::Input& input, const Options& options) {
    const Options settled = begin(input, options);
    return detail::Run(engine_, settled, report_).solve(input, true);
  }

  void reconstruct(const detail::Input& input, const Options& options, Mesh& mesh) {
    const Options settled = begin(input, options);
    detail::Run run(engine_, settled, report_);
    run.extract(run.solve(input, false), mesh);
  }

  DeviceMesh reconstruct(const detail::Input& input, const Options& options) {
    const Options settled = begin(input, options);
    detail::Run run(engine_, settled, report_);
    return run.extract(run.solve(input, false));
  }

  std::vector<Reconstruction> reconstruct_many(std::span<const Cloud> clouds, const Options& options,
                                               Reconstructor& self) {
    validate(options);
    const Device& device = workspace().device();
    if (device.kind != DeviceKind::cpu && engine_.has_lasting_limit())
      return detail::reconstruct_in_turn(clouds, options, self);
    if (!crew_) crew_ = std::make_unique<detail::Crew>(device);
    return crew_->reconstruct(clouds, options, self);
  }

  [[nodiscard]] const RunReport& report() const { return report_; }
  [[nodiscard]] const Workspace& workspace() const { return engine_.workspace(); }

 private:
  /// Checks the options, chooses the depth if it is to be chosen, and begins a report.
  Options begin(const detail::Input& input, const Options& options) {
    validate(options);
    report_ = {};
    engine_.limit_memory(options.max_memory_bytes);
    Options settled = options;
    if (options.depth == Options::kAutomaticDepth) settled.depth = detail::suggest_depth(engine_, input, options).depth;
    check_memory(input, settled);
    return settled;
  }

  void check_memory(const detail::Input& input, const Options& options) const {
    if (options.max_memory_bytes == 0) return;
    const std::int64_t needed = detail::bytes_of_run(engine_, input, options);
    if (needed > options.max_memory_bytes)
      throw Error(
          ErrorCode::over_limit,
          fmt::format("the run would need about {} MB of the {} MB allowed; choose a smaller depth or allow more",
                      needed / 1'000'000, options.max_memory_bytes / 1'000'000));
  }

  detail::Engine engine_;
  RunReport report_;
  std::unique_ptr<detail::Crew> crew_;  // made when it is first needed
};

Reconstructor::Reconstructor(Workspace workspace) : impl_(std::make_unique<Impl>(std::move(workspace))) {}
Reconstructor::~Reconstructor() = default;
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&&) noexcept = default;

Mesh Reconstructor::reconstruct(const Cloud& cloud, const Options& options) {
  Mesh mesh;
  reconstruct(cloud, options, mesh);
  return mesh;
}
Mesh Reconstructor::reconstruct(const Cloud& cloud, const SolveOptions& solve, const ExtractOptions& extract,
                                const RunOptions& run) {
  return reconstruct(cloud, Options(solve, extract, run));
}
void Reconstructor::reconstruct(const Cloud& cloud, const Options& options, Mesh& mesh) {
  impl_->reconstruct(cloud, options, mesh);
}
std::vector<Reconstruction> Reconstructor::reconstruct_many(std::span<const Cloud> clouds, const Options& options) {
  return impl_->reconstruct_many(clouds, options, *this);
}
DeviceMesh Reconstructor::reconstruct_on_device(const Cloud& cloud, const Options& options) {
  return impl_->reconstruct(cloud, options);
}
DeviceMesh Reconstructor::reconstruct(const DevicePoints& points, const Options& options) {
  return impl_->reconstruct(points, options);
}

Field Reconstructor::solve(const Cloud& cloud, const SolveOptions& options, const RunOptions& run) {
  return Field(impl_->solve(cloud, Options(options, {}, run)));
}
Field Reconstructor::solve(const DevicePoints& points, const SolveOptions& options, const RunOptions& run) {
  return Field(impl_->solve(points, Options(options, {}, run)));
}

const RunReport& Reconstructor::report() const { return impl_->report(); }
const Workspace& Reconstructor::workspace() const { return impl_->workspace(); }
const Device& Reconstructor::device() const { return workspace().device(); }

Field::Field(std::shared_ptr<detail::FieldImpl> impl) : impl_(std::move(impl)) {}
double Field::isovalue() const { return impl_->isovalue(); }
double Field::cube_size_world() const { return impl_->cube_size_world(); }
Vec3d Field::cube_lower_world() const { return impl_->cube_lower_world(); }
const Workspace& Field::workspace() const { return impl_->workspace(); }
std::vector<float> Field::values(std::span<const Vec3d> points_world) const { return impl_->values(points_world); }

Mesh Field::extract(const ExtractOptions& options) const {
  Mesh mesh;
  extract(options, mesh);
  return mesh;
}
Mesh Field::extract() const { return extract(ExtractOptions()); }
void Field::extract(const ExtractOptions& options, Mesh& mesh) const { impl_->extract(options, mesh); }
DeviceMesh Field::extract_on_device(const ExtractOptions& options) const { return impl_->extract_on_device(options); }

void validate(const Options& options) {
  require(options.depth == Options::kAutomaticDepth || (options.depth >= 1 && options.depth <= 20), "depth",
          "in 1..20, or automatic");
  validate(options.normal_estimation);
  require(options.screening >= 0 && options.screening <= 1e6, "screening", "in 0..1e6");
  require(options.iterations >= 1 && options.iterations <= 1000, "iterations", "in 1..1000");
  require(options.scale >= 1 && options.scale <= 100, "scale", "in 1..100");
  require(options.samples_per_node >= 0 && options.samples_per_node <= 100, "samples-per-node", "in 0..100");
  require(options.trim == Options::kAutomaticTrim || (options.trim >= 0 && options.trim < 1), "trim",
          "in [0, 1), or automatic");
  require(options.island_ratio >= 0 && options.island_ratio < 1, "island-ratio", "in [0, 1)");
  require(options.min_component >= 0 && std::isfinite(options.min_component) &&
              (options.min_component < 1 || options.min_component == std::floor(options.min_component)),
          "min-component", "a whole number of triangles, or a share in [0, 1)");
  require(std::isfinite(options.offset), "offset", "finite");
  require(std::isfinite(options.isovalue.value_or(0)), "isovalue", "finite");
  require(options.max_memory_bytes >= 0, "max-memory", "at least 0");
  check_combinations(options);
}

const char* name_of(PointNormals normals) {
  constexpr std::array kNames = {"auto", "given", "repair", "estimate"};
  return kNames[static_cast<std::size_t>(normals)];
}

const char* name_of(NormalsDone done) {
  constexpr std::array kNames = {"kept", "turned", "repaired", "estimated"};
  return kNames[static_cast<std::size_t>(done)];
}

namespace detail {

void validate_settled(const Options& options) {
  validate(options);
  require(options.depth != Options::kAutomaticDepth, "depth", "a number here; suggest_depth finds one");
  require(options.trim != Options::kAutomaticTrim, "trim", "a number here");
}

}  // namespace detail
}  // namespace pointskin
