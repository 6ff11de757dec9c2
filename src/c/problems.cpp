#include <pointskin/problems.hpp>

#include <algorithm>
#include <cstdint>

#include "c/convert.hpp"
#include "c/defaults.hpp"

using namespace pointskin;
using namespace pointskin::c;

namespace {

const ProblemRegion& region_at(const psk_problems* problems, std::int64_t index) {
  const auto& regions = required(problems, "problems").regions;
  if (index < 0 || index >= static_cast<std::int64_t>(regions.size()))
    throw Error(ErrorCode::usage, "there is no problem number " + std::to_string(index) + "; there are " +
                                      std::to_string(regions.size()));
  return regions[static_cast<std::size_t>(index)];
}

psk_problem_view view_of(const ProblemView& from) {
  psk_problem_view to{};
  to.azimuth_degrees = from.azimuth_degrees;
  to.elevation_degrees = from.elevation_degrees;
  store(from.target_world, to.target);
  std::copy(from.matrix.begin(), from.matrix.end(), to.matrix);
  to.zoom = from.zoom;
  to.visible = from.visible;
  return to;
}

}  // namespace

psk_code psk_find_problems(const psk_mesh* mesh, const psk_problem_options* options, psk_problems** problems,
                           psk_error* error) {
  return guarded(error, [&] {
    const psk_problem_options from = known(options);
    const ProblemOptions how{from.threshold, from.least_area, enumerator("up", from.up, UpAxis::minus_z), from.threads};
    required(problems, "problems") = new psk_problems{find_problems(*HostMesh(mesh), how)};
  });
}

int64_t psk_problems_count(const psk_problems* problems) {
  return problems == nullptr ? 0 : static_cast<std::int64_t>(problems->regions.size());
}

psk_code psk_problems_get(const psk_problems* problems, int64_t index, psk_problem* problem, psk_error* error) {
  return guarded(error, [&] {
    const ProblemRegion& from = region_at(problems, index);
    auto to = defaults<psk_problem>();
    to.score = from.score;
    to.peak = from.peak;
    to.area = from.area;
    store(from.centroid_world, to.centroid);
    store(from.lower_world, to.lower);
    store(from.upper_world, to.upper);
    store(from.mean_normal, to.mean_normal);
    to.triangles = from.triangles;
    to.view_count = static_cast<std::int32_t>(std::min<std::size_t>(from.views.size(), 3));
    for (std::size_t v = 0; v < static_cast<std::size_t>(to.view_count); ++v) to.views[v] = view_of(from.views[v]);
    give(to, &required(problem, "problem"));
  });
}

psk_code psk_problems_render(const psk_problems* problems, int64_t index, int32_t view, const psk_mesh* mesh,
                             const psk_render_options* options, const char* caption, psk_image** image,
                             psk_error* error) {
  return guarded(error, [&] {
    const ProblemRegion& region = region_at(problems, index);
    if (view < 0) throw Error(ErrorCode::usage, "there is no view of a negative number");
    required(image, "image") =
        new psk_image{render_problem(*HostMesh(mesh), region, static_cast<std::size_t>(view),
                                     render_options_of(options), caption == nullptr ? "" : caption),
                      {}};
  });
}

void psk_problems_free(psk_problems* problems) { delete problems; }
