#include "normals/orient.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/announce.hpp"
#include "core/vec3.hpp"
#include "exec/this_space.hpp"
#include "normals/estimate_normals.hpp"
#include "normals/likely_signs.hpp"
#include "normals/neighbours.hpp"
#include "normals/prepared_cloud.hpp"
#include "normals/sign_solver.hpp"
#include "reconstruct/phase_clock.hpp"
#include "reconstruct/points.hpp"

namespace pointskin::normals {
namespace {

enum Fate : std::int32_t { estimated, kept, flipped, replaced };

/// Normals in the cloud's order. Given ones that lie near enough to the line stay, with the sign that was found.
struct WriteNormals {
  ArrayView<const std::int32_t> order, signs;
  ArrayView<const Vec3f> lines, given;  // given: empty or (n)
  double least_cosine_squared;
  ArrayView<Vec3f> out;
  ArrayView<std::int32_t> fates;

  PSK_HD void operator()(std::int64_t i) const {
    const auto s = static_cast<float>(signs[i]);
    const Vec3f n = lines[i];
    Vec3f result{s * n.x, s * n.y, s * n.z};
    Fate fate = estimated;
    if (!given.empty()) {
      const Vec3f g = given[i];
      const Vec3d exact = to_double(g);
      const double squared = dot(exact, exact);
      const double along = dot(exact, to_double(result));
      fate = replaced;
      if (squared > 0 && along * along >= least_cosine_squared * squared) {
        fate = along < 0 ? flipped : kept;
        result = along < 0 ? Vec3f{-g.x, -g.y, -g.z} : g;
      } else if (squared == 0) {
        fate = estimated;
      }
    }
    out[order[i]] = result;
    fates[i] = fate;
  }
};

struct FateCounts {
  std::int64_t of[4] = {};
  std::int64_t doubtful = 0;
};
struct CountFates {
  ArrayView<const std::int32_t> fates;
  ArrayView<const float> confidence;
  PSK_HD FateCounts operator()(std::int64_t i) const {
    FateCounts counts;
    counts.of[fates[i]] = 1;
    counts.doubtful = confidence[i] < 0.5F ? 1 : 0;
    return counts;
  }
};
struct AddFates {
  PSK_HD FateCounts operator()(FateCounts a, const FateCounts& b) const {
    for (int f = 0; f < 4; ++f) a.of[f] += b.of[f];
    a.doubtful += b.doubtful;
    return a;
  }
};

/// Lines to the likelier of their signs, and what is said of signs with them.
struct TurnLines {
  ArrayView<const std::int32_t> signs;
  ArrayView<Vec3f> lines;
  ArrayView<float> curvature;
  ArrayView<std::int32_t> evidence;
  PSK_HD void operator()(std::int64_t i) const {
    if (signs[i] > 0) return;
    lines[i] = {-lines[i].x, -lines[i].y, -lines[i].z};
    curvature[i] = -curvature[i];
    evidence[i] = -evidence[i];
  }
};

constexpr float kLargestFloat = 3.4028234663852886e38F;

/// A value of each sample to the cloud's order, times a factor and, if there are signs, the sign; 3.4e38 at most.
struct Scatter {
  ArrayView<const std::int32_t> order, signs;
  ArrayView<const float> in;
  float factor;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    const float value = factor * in[i] * (signs.empty() ? 1.0F : static_cast<float>(signs[i]));
    out[order[i]] = value > kLargestFloat ? kLargestFloat : value < -kLargestFloat ? -kLargestFloat : value;
  }
};

void set_attribute(Cloud& cloud, const char* name, std::vector<float> values) {
  const auto at = std::find_if(cloud.attributes.begin(), cloud.attributes.end(),
                               [&](const Attribute& a) { return a.name == name; });
  Attribute attribute{name, std::move(values)};
  if (at == cloud.attributes.end())
    cloud.attributes.push_back(std::move(attribute));
  else
    *at = std::move(attribute);
}

/// What is a guess, in a sentence.
/// @param is_certain  Evidence::is_certain
std::string assumption(const NormalReport& report, bool is_certain) {
  constexpr double kClosed = 0.3;
  constexpr double kFlat = 0.03;
  switch (report.method) {
    case NormalMethod::sensor:
      return "every point was seen from its sensor";
    case NormalMethod::repair:
      if (report.flipped > 9 * report.kept)
        return "the points surround solids: given normals pointed into what they enclose";
      if (is_certain) return "sheets lie nearer to each other than points do: the given normals know their sides";
      return "most given normals of a connected part are right, where they say anything";
    default:
      break;
  }
  if (report.enclosing > kClosed) return "the points surround solids: normals point away from what they enclose";
  if (report.enclosing > kFlat)
    return "the scan is open: normals point to the convex side, as if it bounded a solid; "
           "if the sensor was inside, give its position";
  return "the points enclose nothing: which side is outside is a guess; give the sensor's position";
}

/// Tells the caller where the run is. @throws Error interrupted if it wants to stop
/// @returns the mean vote of links; 0: the evidence says nothing of single points
template <exec::Space Exec>
double turn_lines(Exec& ex, const LinkedLines& linked, NormalLines& lines, exec::Buffer<std::int32_t>& evidence) {
  const LikelySigns likely = spread_evidence(ex, linked, evidence.cview());
  for_each(ex, "normals.turn", likely.signs.size(),
           TurnLines{likely.signs.cview(), lines.normals.view(), lines.curvature.view(), evidence.view()});
  return likely.typical;
}

/// What was found of every sample, in the order of the tree.
struct Found {
  const PreparedCloud& points;
  const NormalLines& lines;
  const exec::Buffer<std::int32_t>& signs;
  const exec::Buffer<float>& confidence;
};

template <exec::Space Exec>
std::vector<float> scattered(Exec& ex, const PreparedCloud& points, const exec::Buffer<float>& values,
                             ArrayView<const std::int32_t> signs, float factor) {
  auto out = exec::make_buffer<float>(ex, values.size());
  for_each(ex, "normals.scatter", values.size(),
           Scatter{points.order.cview(), signs, values.cview(), factor, out.view()});
  std::vector<float> host;
  detail::download_array(ex, out, host);
  return host;
}

template <exec::Space Exec>
void write(Exec& ex, const Found& found, const NormalOptions& options, Cloud& cloud, NormalReport& report) {
  const PreparedCloud& points = found.points;
  const std::int64_t n = points.positions.size();
  auto out = exec::make_buffer<Vec3f>(ex, n);
  auto fates = exec::make_buffer<std::int32_t>(ex, n);
  const double cosine = std::cos(options.keep_within_degrees * 3.14159265358979323846 / 180);
  const bool keep = options.method == NormalMethod::repair;
  for_each(
      ex, "normals.write", n,
      WriteNormals{points.order.cview(), found.signs.cview(), found.lines.normals.cview(),
                   keep ? points.given.cview() : ArrayView<const Vec3f>{}, cosine * cosine, out.view(), fates.view()});
  const auto counts =
      exec::reduce<FateCounts>(ex, "normals.count", n, CountFates{fates.cview(), found.confidence.cview()}, AddFates{});
  report.kept = counts.of[kept];
  report.flipped = counts.of[flipped];
  report.replaced = counts.of[replaced];
  report.given = report.kept + report.flipped + report.replaced;
  report.doubtful = counts.doubtful;
  if (options.confidence) set_attribute(cloud, "confidence", scattered(ex, points, found.confidence, {}, 1));
  if (options.curvature) {
    const double per_unit = std::min<double>(1 / points.frame.size, kLargestFloat);
    set_attribute(cloud, "curvature",
                  scattered(ex, points, found.lines.curvature, found.signs.cview(), static_cast<float>(per_unit)));
  }
  detail::download_array(ex, out, cloud.normals);
}

}  // namespace

template <exec::Space Exec>
void orient(Exec& ex, Cloud& cloud, const Views& views, const NormalOptions& options, NormalReport& report) {
  ex.pool()->reset_peak();
  report.points = cloud.size();
  announce(options.progress, "estimate", 0);
  detail::PhaseClock clock(ex);
  const PreparedCloud points = prepare_cloud(ex, cloud);
  const octree::SearchView search{points.tree.view(), points.positions.cview(), {}};
  const exec::Buffer<std::int32_t> neighbours = find_neighbours(ex, search);
  NormalLines lines = estimate_lines(ex, search, neighbours.cview());
  clock.lap(report.estimate_ms);

  announce(options.progress, "propagate", 0.3);
  exec::Buffer<std::int32_t> evidence = find_evidence(ex, points, lines.normals.cview(), views, options.method);
  const LinkedLines linked{points.positions.cview(), lines.normals.cview(), lines.flatness.cview(), lines.noise.cview(),
                           neighbours.cview()};
  const double typical = evidence.empty() ? 0 : turn_lines(ex, linked, lines, evidence);
  const Evidence known{evidence.cview(), typical, views.turns_given};
  SignSolver<Exec> solver(ex, linked, points.tree, known, options, report);
  solver.propagate();
  clock.lap(report.propagate_ms);
  announce(options.progress, "iterate", 0.5);
  solver.judge();
  clock.lap(report.iterate_ms);
  write(ex, {points, lines, solver.signs(), solver.confidence()}, options, cloud, report);
  clock.read();
  report.assumed = assumption(report, known.is_certain());
  report.device_peak_bytes = ex.pool()->peak_bytes();
}

PSK_INSTANTIATE(orient);

}  // namespace pointskin::normals
