#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "reconstruct/engine.hpp"
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
  if (options.offset == 0) return;
  exclude(options.weakness, "options offset and weakness exclude each other: there are no samples on the surface");
  exclude(options.trim != 0, "options offset and trim exclude each other");
  exclude(options.density, "options offset and density exclude each other: there are no samples on the surface");
  exclude(options.attributes, "options offset and attributes exclude each other: there are no samples on the surface");
  exclude(options.envelope != nullptr, "options offset and envelope exclude each other");
  exclude(options.domain_faces == DomainFaces::open, "an offset surface is closed: domain_faces must be closed");
}

}  // namespace

class Reconstructor::Impl {
 public:
  explicit Impl(Device device) : device_(device), engine_(detail::make_engine(device)) {}

  /// Checks the options, chooses the depth if it is to be chosen, and begins a report.
  Options begin(const Cloud& cloud, const Options& options) {
    validate(options);
    report_ = {};
    engine_->limit_memory(options.max_memory_bytes);
    Options settled = options;
    if (options.depth == Options::kAutomaticDepth)
      settled.depth = detail::suggest_depth(*engine_, device_, cloud, options).depth;
    check_memory(cloud, settled);
    return settled;
  }

  std::shared_ptr<detail::FieldImpl> solve(const Cloud& cloud, const Options& options) {
    const Options settled = begin(cloud, options);
    return detail::Run(*engine_, device_, settled, report_).solve(cloud);
  }

  void reconstruct(const Cloud& cloud, const Options& options, Mesh& mesh) {
    const Options settled = begin(cloud, options);
    detail::Run run(*engine_, device_, settled, report_);
    run.extract(run.solve(cloud), mesh);
  }

  std::vector<RunTimes> repeat(const Cloud& cloud, const Options& options, int times) {
    const RunReport before = std::move(report_);
    const Options settled = begin(cloud, options);
    RunReport unused;
    std::vector<RunTimes> runs = detail::Run(*engine_, device_, settled, unused).repeat(cloud, times);
    report_ = before;
    return runs;
  }

  void check_memory(const Cloud& cloud, const Options& options) const {
    if (options.max_memory_bytes == 0) return;
    const std::int64_t needed = estimate_device_bytes(cloud, options, device_.threads);
    if (needed > options.max_memory_bytes)
      throw Error(
          ErrorCode::over_limit,
          fmt::format("the run would need about {} MB of the {} MB allowed; choose a smaller depth or allow more",
                      needed / 1'000'000, options.max_memory_bytes / 1'000'000));
  }

  Device device_;
  std::unique_ptr<detail::Engine> engine_;
  RunReport report_;
};

Reconstructor::Reconstructor(Device device) : impl_(std::make_unique<Impl>(device)) {}
Reconstructor::~Reconstructor() = default;
Reconstructor::Reconstructor(Reconstructor&&) noexcept = default;
Reconstructor& Reconstructor::operator=(Reconstructor&&) noexcept = default;

Field Reconstructor::solve(const Cloud& cloud, const Options& options) { return Field(impl_->solve(cloud, options)); }

Mesh Reconstructor::reconstruct(const Cloud& cloud, const Options& options) {
  Mesh mesh;
  reconstruct(cloud, options, mesh);
  return mesh;
}

void Reconstructor::reconstruct(const Cloud& cloud, const Options& options, Mesh& mesh) {
  impl_->reconstruct(cloud, options, mesh);
}

std::vector<RunTimes> Reconstructor::repeat(const Cloud& cloud, const Options& options, int times) {
  require(times > 0, "repeat", "at least 1");
  return impl_->repeat(cloud, options, times);
}

const RunReport& Reconstructor::report() const { return impl_->report_; }
const Device& Reconstructor::device() const { return impl_->device_; }

Field::Field(std::shared_ptr<detail::FieldImpl> impl) : impl_(std::move(impl)) {}
double Field::isovalue() const { return impl_->isovalue(); }
double Field::cube_size_world() const { return impl_->cube_size_world(); }
Vec3d Field::cube_lower_world() const { return impl_->cube_lower_world(); }
std::vector<float> Field::values(const std::vector<Vec3d>& points_world) const { return impl_->values(points_world); }

Mesh Field::extract() const {
  Mesh mesh;
  impl_->extract(mesh);
  return mesh;
}

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
