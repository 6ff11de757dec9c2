#include <pointskin/boolean.hpp>

#include <memory>
#include <utility>

#include "c/convert.hpp"
#include "c/defaults.hpp"

using namespace pointskin;
using namespace pointskin::c;

namespace {

BooleanOptions boolean_options_of(const psk_boolean_options* given) {
  const psk_boolean_options from = known(given);
  BooleanOptions to;
  to.reconstruction = options_of(from.reconstruction);
  to.creases = from.creases != 0 ? Creases::sampled : Creases::none;
  to.coincidence_cells = from.coincidence_cells;
  return to;
}

psk_boolean_report report_of(const BooleanReport& from) {
  auto to = defaults<psk_boolean_report>();
  const BooleanPart* const parts[] = {&from.a, &from.b};
  for (int i = 0; i < 2; ++i) {
    to.points[i] = parts[i]->points;
    to.strays[i] = parts[i]->strays;
    to.kept[i] = parts[i]->kept;
    to.flipped[i] = parts[i]->flipped;
    to.dropped[i] = parts[i]->dropped;
    to.coincident[i] = parts[i]->coincident;
  }
  to.added = from.added;
  to.device_peak_bytes = from.device_peak_bytes;
  to.curve_length = from.curve_length;
  to.classify_ms = from.classify_ms;
  to.crease_ms = from.crease_ms;
  to.gather_ms = from.gather_ms;
  to.apart_ms = from.apart_ms;
  to.total_ms = from.total_ms;
  return to;
}

}  // namespace

psk_code psk_boolean(psk_workspace* workspace, const psk_mesh* a_mesh, const psk_cloud* a_cloud, const psk_mesh* b_mesh,
                     const psk_cloud* b_cloud, int32_t operation, const psk_boolean_options* options, psk_mesh** mesh,
                     psk_cloud** cloud, psk_boolean_report* report, psk_error* error) {
  return guarded(error, [&] {
    const MeshOrCloud a(a_mesh, a_cloud, "A");
    const MeshOrCloud b(b_mesh, b_cloud, "B");
    const auto op = enumerator("operation", operation, BooleanOp::symmetric_difference);
    const BooleanOptions how = boolean_options_of(options);
    required(mesh, "mesh");
    Booleans booleans(required(workspace, "workspace").workspace);
    BooleanResult result = a.visit([&](const auto& first) {
      return b.visit([&](const auto& second) { return booleans.combine(first, second, op, how); });
    });
    give(report_of(result.report), report);
    std::unique_ptr<psk_mesh> made(new_mesh(std::move(result.mesh)));
    if (cloud != nullptr) *cloud = new_cloud(std::move(result.cloud));
    *mesh = made.release();
  });
}
