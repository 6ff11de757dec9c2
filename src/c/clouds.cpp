#include <pointskin/merge.hpp>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "c/convert.hpp"
#include "c/defaults.hpp"

using namespace pointskin;
using namespace pointskin::c;

psk_code psk_cloud_create(const psk_points* points, const psk_read_options* options, psk_cloud** cloud,
                          psk_error* error) {
  return guarded(error, [&] {
    if (is_on_device(known(&required(points, "points"))))
      throw Error(ErrorCode::usage, "a cloud is made of arrays on the host; psk_reconstruct_points() takes others");
    required(cloud, "cloud") = new_cloud(cloud_of(strided(points), read_options_of(options)));
  });
}

psk_code psk_cloud_read(const char* path, const psk_read_options* options, psk_cloud** cloud, psk_error* error) {
  return guarded(error, [&] {
    required(cloud, "cloud") = new_cloud(read_cloud(&required(path, "path"), read_options_of(options)));
  });
}

psk_code psk_cloud_copy(const psk_cloud* cloud, psk_cloud** copy, psk_error* error) {
  return guarded(error, [&] { required(copy, "copy") = new_cloud(required(cloud, "cloud").cloud); });
}

void psk_cloud_free(psk_cloud* cloud) { delete cloud; }

int64_t psk_cloud_size(const psk_cloud* cloud) { return cloud == nullptr ? 0 : cloud->cloud.size(); }

int64_t psk_cloud_dropped(const psk_cloud* cloud) { return cloud == nullptr ? 0 : cloud->cloud.dropped; }

void psk_cloud_origin(const psk_cloud* cloud, double origin[3]) {
  store(cloud == nullptr ? Vec3d{} : cloud->cloud.origin, origin);
}

psk_array psk_cloud_positions(const psk_cloud* cloud) {
  return cloud == nullptr ? psk_array{} : array_of(cloud->cloud.positions, PSK_HOST);
}

psk_array psk_cloud_normals(const psk_cloud* cloud) {
  return cloud == nullptr || !cloud->cloud.has_normals() ? psk_array{} : array_of(cloud->cloud.normals, PSK_HOST);
}

int64_t psk_cloud_attribute_count(const psk_cloud* cloud) {
  return cloud == nullptr ? 0 : static_cast<std::int64_t>(cloud->cloud.attributes.size());
}

psk_attribute psk_cloud_attribute(const psk_cloud* cloud, int64_t index) {
  if (index < 0 || index >= psk_cloud_attribute_count(cloud)) return {};
  return attribute_of(cloud->cloud.attributes[static_cast<std::size_t>(index)]);
}

psk_code psk_cloud_merge(psk_cloud* cloud, const psk_cloud* more, psk_error* error) {
  return guarded(error, [&] {
    Cloud copy = required(more, "more").cloud;
    merge_into(required(cloud, "cloud").cloud, std::move(copy));
  });
}

psk_code psk_cloud_keep(psk_cloud* cloud, const uint8_t* keep, int64_t count, psk_error* error) {
  return guarded(error, [&] {
    required(cloud, "cloud");
    if (count > 0) required(keep, "keep");
    std::vector<bool> flags(static_cast<std::size_t>(std::max<std::int64_t>(count, 0)));
    for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = keep[i] != 0;
    keep_where(cloud->cloud, flags);
  });
}

psk_code psk_cloud_write(const psk_cloud* cloud, const char* path, const psk_write_options* options, psk_error* error) {
  return guarded(
      error, [&] { write_cloud(&required(path, "path"), required(cloud, "cloud").cloud, write_options_of(options)); });
}

psk_code psk_orient(psk_workspace* workspace, psk_cloud* cloud, const psk_normal_options* options,
                    psk_normal_report* report, psk_error* error) {
  return guarded(error, [&] {
    NormalEstimator estimator(required(workspace, "workspace").workspace);
    psk_cloud& target = required(cloud, "cloud");
    estimator.orient(target.cloud, normal_options_of(options));
    const NormalReport& from = estimator.report();
    const std::optional<Warning> warning = warning_of_doubts(from);
    target.assumed = from.assumed;
    target.warning = warning ? warning->text : std::string();
    auto to = defaults<psk_normal_report>();
    to.assumed = target.assumed.c_str();
    to.warning = warning ? target.warning.c_str() : nullptr;
    to.points = from.points;
    to.given = from.given;
    to.kept = from.kept;
    to.flipped = from.flipped;
    to.replaced = from.replaced;
    to.doubtful = from.doubtful;
    to.patches = from.patches;
    to.components = from.components;
    to.turned = from.turned;
    to.device_peak_bytes = from.device_peak_bytes;
    to.enclosing = from.enclosing;
    to.estimate_ms = from.estimate_ms;
    to.propagate_ms = from.propagate_ms;
    to.iterate_ms = from.iterate_ms;
    to.total_ms = from.total_ms;
    to.method = static_cast<std::int32_t>(from.method);
    to.rounds = from.rounds;
    to.settled = from.settled ? 1 : 0;
    give(to, report);
  });
}
