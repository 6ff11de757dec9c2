#include <pointskin/normals.hpp>

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "core/stopwatch.hpp"
#include "exec/any_space.hpp"
#include "normals/orient.hpp"
#include "normals/trial_size.hpp"

namespace pointskin {
namespace {

void require(bool holds, const char* story) {
  if (!holds) throw Error(ErrorCode::usage, story);
}

struct ViewNames {
  std::array<const char*, 3> names;
  bool is_position;
};
constexpr ViewNames kViewNames[] = {
    {{"view_x", "view_y", "view_z"}, false}, {{"vx", "vy", "vz"}, false}, {{"sensor_x", "sensor_y", "sensor_z"}, true}};

const Attribute* find(const Cloud& cloud, const std::string& name) {
  const auto at = std::find_if(cloud.attributes.begin(), cloud.attributes.end(), [&](const Attribute& a) {
    return a.name == name && static_cast<std::int64_t>(a.values.size()) == cloud.size();
  });
  return at == cloud.attributes.end() ? nullptr : &*at;
}

/// The attributes of the first triple that the cloud has; null if it has none.
const ViewNames* find_views(const Cloud& cloud, std::array<const Attribute*, 3>& values) {
  for (const ViewNames& triple : kViewNames) {
    for (std::size_t a = 0; a < 3; ++a) values[a] = find(cloud, triple.names[a]);
    if (values[0] != nullptr && values[1] != nullptr && values[2] != nullptr) return &triple;
  }
  return nullptr;
}

normals::Views find_views(const Cloud& cloud, const NormalOptions& options) {
  normals::Views views;
  for (const Vec3d& sensor : options.sensors) views.sensors.push_back(sensor - cloud.origin);
  if (!views.sensors.empty()) return views;
  std::array<const Attribute*, 3> values{};
  const ViewNames* const triple = find_views(cloud, values);
  if (triple == nullptr) return views;
  views.towards.resize(cloud.positions.size());
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3f& p = cloud.positions[i];
    const std::array<double, 3> at = {p.x, p.y, p.z};
    std::array<double, 3> v{};
    for (std::size_t a = 0; a < 3; ++a) {
      v[a] = values[a]->values.at(i);
      if (triple->is_position) v[a] -= cloud.origin[a] + at[a];
      if (!std::isfinite(v[a])) v[a] = 0;  // this point says nothing
    }
    views.towards[i] = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
  }
  return views;
}

NormalMethod chosen_method(const Cloud& cloud, const normals::Views& views, NormalMethod method) {
  if (method == NormalMethod::automatic) {
    if (!views.empty()) return NormalMethod::sensor;
    return cloud.has_normals() ? NormalMethod::repair : NormalMethod::propagate;
  }
  require(method != NormalMethod::sensor || !views.empty(),
          "the method sensor needs a sensor's position, or the points' attributes view_x, view_y and view_z");
  if (method == NormalMethod::repair && !cloud.has_normals())
    throw Error(ErrorCode::no_normals, "there are no normals to repair; use another method");
  return method;
}

}  // namespace

class PSK_HIDDEN NormalEstimator::Impl {
 public:
  Workspace workspace;
  NormalReport report;
};

NormalEstimator::NormalEstimator(Workspace workspace) : impl_(std::make_unique<Impl>(Impl{std::move(workspace), {}})) {}
NormalEstimator::~NormalEstimator() = default;
NormalEstimator::NormalEstimator(NormalEstimator&&) noexcept = default;
NormalEstimator& NormalEstimator::operator=(NormalEstimator&&) noexcept = default;

void NormalEstimator::orient(Cloud& cloud, const NormalOptions& options) {
  validate(options);
  const Stopwatch watch;
  normals::Views views = find_views(cloud, options);
  NormalOptions settled = options;
  settled.method = chosen_method(cloud, views, options.method);
  views.turns_given = options.method == NormalMethod::automatic && settled.method == NormalMethod::repair;
  NormalReport& report = impl_->report;
  report = {};
  report.method = settled.method;
  exec::visit(impl_->workspace.data().space, [&](auto& ex) { normals::orient(ex, cloud, views, settled, report); });
  report.total_ms = watch.milliseconds();
}

const NormalReport& NormalEstimator::report() const { return impl_->report; }
const Device& NormalEstimator::device() const { return impl_->workspace.device(); }

std::int64_t estimate_normals_device_bytes(const Cloud& cloud, int threads) {
  constexpr std::int64_t kLinks = 540;   // a point, while patches are made: 370 to 500 measured
  constexpr std::int64_t kBeside = 180;  // a point, beside a trial field: 100 to 130
  Options trial;
  trial.depth = normals::trial_depth(cloud.size());
  trial.scale = normals::kTrialRoom;
  return std::max(kLinks * cloud.size(), estimate_device_bytes(cloud, trial, threads) + kBeside * cloud.size());
}

void validate(const NormalOptions& options) {
  require(options.max_rounds >= 1 && options.max_rounds <= 1000, "option max-rounds must be in 1..1000");
  require(options.time_limit_s >= 0 && std::isfinite(options.time_limit_s), "option time-limit must be at least 0 s");
  require(options.keep_within_degrees >= 0 && options.keep_within_degrees <= 90,
          "option keep-within must be in 0..90 degrees");
  for (const Vec3d& sensor : options.sensors)
    require(std::isfinite(sensor[0]) && std::isfinite(sensor[1]) && std::isfinite(sensor[2]),
            "the position of a sensor must be finite");
}

const char* name_of(NormalMethod method) {
  switch (method) {
    case NormalMethod::automatic:
      return "auto";
    case NormalMethod::sensor:
      return "sensor";
    case NormalMethod::propagate:
      return "propagate";
    case NormalMethod::iterate:
      return "iterate";
    case NormalMethod::repair:
      break;
  }
  return "repair";
}

bool has_view_attributes(const Cloud& cloud) {
  std::array<const Attribute*, 3> values{};
  return find_views(cloud, values) != nullptr;
}

}  // namespace pointskin
