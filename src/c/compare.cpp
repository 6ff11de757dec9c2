#include <algorithm>
#include <vector>

#include "c/convert.hpp"
#include "c/defaults.hpp"

using namespace pointskin;
using namespace pointskin::c;

namespace {

void set_statistics(const DistanceStatistics& from, double (&to)[4]) {
  to[0] = from.mean;
  to[1] = from.rms;
  to[2] = from.p95;
  to[3] = from.max;
}

/// f(ComparedSurface, ComparedSurface).
template <class F>
auto with_both(const MeshOrCloud& surface, const MeshOrCloud& reference, const F& f) {
  return surface.visit([&](const auto& a) {
    return reference.visit([&](const auto& b) { return f(ComparedSurface(a), ComparedSurface(b)); });
  });
}

}  // namespace

psk_code psk_compare(const psk_mesh* mesh, const psk_cloud* cloud, const psk_mesh* reference_mesh,
                     const psk_cloud* reference_cloud, const psk_compare_options* options, psk_comparison* comparison,
                     psk_error* error) {
  return guarded(error, [&] {
    const psk_compare_options given = known(options);
    const CompareOptions how{given.samples, given.tau, given.threads};
    const MeshComparison from = with_both(
        MeshOrCloud(mesh, cloud, "what is compared"), MeshOrCloud(reference_mesh, reference_cloud, "the reference"),
        [&](const ComparedSurface& a, const ComparedSurface& b) { return compare(a, b, how); });
    auto to = defaults<psk_comparison>();
    to.reference_diagonal = from.reference_diagonal;
    to.samples = from.samples;
    to.reference_samples = from.reference_samples;
    set_statistics(from.to_reference, to.to_reference);
    set_statistics(from.from_reference, to.from_reference);
    set_statistics(from.two_sided, to.two_sided);
    to.normal_consistency = from.normal_consistency;
    to.precision = from.precision;
    to.recall = from.recall;
    to.f_score = from.f_score;
    to.has_normals = from.has_normals ? 1 : 0;
    give(to, &required(comparison, "comparison"));
  });
}

psk_code psk_distances(const psk_mesh* mesh, const psk_cloud* cloud, const psk_mesh* reference_mesh,
                       const psk_cloud* reference_cloud, int32_t with_sign, int32_t threads, double* distances,
                       psk_error* error) {
  return guarded(error, [&] {
    const DistanceOptions how{with_sign != 0, threads};
    const std::vector<double> found = with_both(
        MeshOrCloud(mesh, cloud, "what is compared"), MeshOrCloud(reference_mesh, reference_cloud, "the reference"),
        [&](const ComparedSurface& a, const ComparedSurface& b) { return pointskin::distances(a, b, how); });
    if (!found.empty()) std::copy(found.begin(), found.end(), &required(distances, "distances"));
  });
}
