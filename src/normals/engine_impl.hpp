// What a NormalEstimator delegates to, once for every space.
#pragma once

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "exec/algorithms.hpp"
#include "normals/engine.hpp"
#include "normals/estimate_normals.hpp"
#include "normals/likely_signs.hpp"
#include "normals/neighbours.hpp"
#include "normals/prepared_cloud.hpp"
#include "normals/sign_solver.hpp"
#include "reconstruct/phase_clock.hpp"

namespace pointskin::detail {
namespace lines {

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
      const Double3 exact = to_double(g);
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

/// A value of each sample to the cloud's order, times a factor and, if there are signs, the sign.
struct Scatter {
  ArrayView<const std::int32_t> order, signs;
  ArrayView<const float> in;
  float factor;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    out[order[i]] = factor * in[i] * (signs.empty() ? 1.0F : static_cast<float>(signs[i]));
  }
};

inline void set_attribute(Cloud& cloud, const char* name, std::vector<float> values) {
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
inline std::string assumption(const NormalReport& report, bool is_certain) {
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

}  // namespace lines

template <exec::Space Exec>
class NormalsOn final : public NormalEngine {
 public:
  explicit NormalsOn(std::shared_ptr<Exec> ex) : ex_(std::move(ex)) {}

  void orient(Cloud& cloud, const Views& views, const NormalOptions& options, NormalReport& report) override {
    ex_->activate();
    ex_->pool()->reset_peak();
    report.points = cloud.size();
    announce(options, "estimate", 0);
    PhaseClock clock(*ex_);
    const PreparedCloud points = prepare_cloud(*ex_, cloud);
    const octree::SearchView search{points.tree.view(), points.positions.cview(), {}};
    const exec::Buffer<std::int32_t> neighbours = normals::find_neighbours(*ex_, search);
    normals::NormalLines lines = normals::estimate_lines(*ex_, search, neighbours.cview());
    clock.lap(report.estimate_ms);

    announce(options, "propagate", 0.3);
    exec::Buffer<std::int32_t> evidence = find_evidence(points, lines, views, options);
    const normals::LinkedLines linked{points.positions.cview(), lines.normals.cview(), lines.flatness.cview(),
                                      lines.noise.cview(), neighbours.cview()};
    const double typical = evidence.empty() ? 0 : turn_lines(linked, lines, evidence);
    const Evidence known{evidence.cview(), typical, views.turns_given};
    SignSolver<Exec> solver(*ex_, linked, points.tree, known, options, report);
    solver.propagate();
    clock.lap(report.propagate_ms);
    announce(options, "iterate", 0.5);
    solver.judge();
    clock.lap(report.iterate_ms);
    write(points, lines, solver, options, cloud, report);
    clock.read();
    report.assumed = lines::assumption(report, known.is_certain());
    report.device_peak_bytes = ex_->pool()->peak_bytes();
  }

 private:
  static void announce(const NormalOptions& options, const char* phase, double fraction) {
    if (options.progress && !options.progress({phase, fraction}))
      throw Error(ErrorCode::interrupted, std::string("cancelled before the phase \"") + phase + "\"");
  }

  exec::Buffer<std::int32_t> find_evidence(const PreparedCloud& points, const normals::NormalLines& lines,
                                           const Views& views, const NormalOptions& options) {
    exec::Buffer<std::int32_t> evidence;
    const std::int64_t n = points.positions.size();
    if (options.method == NormalMethod::repair) {
      evidence = exec::make_buffer<std::int32_t>(*ex_, n);
      for_each(*ex_, "normals.given", n,
               prepare::GivenSide{points.given.cview(), lines.normals.cview(), evidence.view()});
    } else if (options.method == NormalMethod::sensor) {
      evidence = exec::make_buffer<std::int32_t>(*ex_, n);
      auto sensors = exec::make_buffer<Vec3d>(*ex_, static_cast<std::int64_t>(views.sensors.size()));
      copy_to_device(*ex_, views.sensors.data(), sensors.view());
      auto towards = exec::make_buffer<Vec3f>(*ex_, static_cast<std::int64_t>(views.towards.size()));
      copy_to_device(*ex_, views.towards.data(), towards.view());
      for_each(*ex_, "normals.seen", n,
               prepare::SeenFrom{points.frame, points.positions.cview(), lines.normals.cview(), points.order.cview(),
                                 sensors.cview(), towards.cview(), evidence.view()});
    }
    return evidence;
  }

  /// @returns the mean vote of links; 0: the evidence says nothing of single points
  double turn_lines(const normals::LinkedLines& linked, normals::NormalLines& lines,
                    exec::Buffer<std::int32_t>& evidence) {
    const normals::LikelySigns likely = normals::spread_evidence(*ex_, linked, evidence.cview());
    for_each(*ex_, "normals.turn", likely.signs.size(),
             lines::TurnLines{likely.signs.cview(), lines.normals.view(), lines.curvature.view(), evidence.view()});
    return likely.typical;
  }

  void write(const PreparedCloud& points, const normals::NormalLines& lines, const SignSolver<Exec>& solver,
             const NormalOptions& options, Cloud& cloud, NormalReport& report) {
    const std::int64_t n = points.positions.size();
    auto out = exec::make_buffer<Vec3f>(*ex_, n);
    auto fates = exec::make_buffer<std::int32_t>(*ex_, n);
    const double cosine = std::cos(options.keep_within_degrees * 3.14159265358979323846 / 180);
    const bool keep = options.method == NormalMethod::repair;
    for_each(*ex_, "normals.write", n,
             lines::WriteNormals{points.order.cview(), solver.signs().cview(), lines.normals.cview(),
                                 keep ? points.given.cview() : ArrayView<const Vec3f>{}, cosine * cosine, out.view(),
                                 fates.view()});
    const auto counts = exec::reduce<lines::FateCounts>(
        *ex_, "normals.count", n, lines::CountFates{fates.cview(), solver.confidence().cview()}, lines::AddFates{});
    report.kept = counts.of[lines::kept];
    report.flipped = counts.of[lines::flipped];
    report.replaced = counts.of[lines::replaced];
    report.given = report.kept + report.flipped + report.replaced;
    report.doubtful = counts.doubtful;
    if (options.confidence) lines::set_attribute(cloud, "confidence", scattered(points, solver.confidence(), {}, 1));
    if (options.curvature)
      lines::set_attribute(
          cloud, "curvature",
          scattered(points, lines.curvature, solver.signs().cview(), static_cast<float>(1 / points.frame.size)));
    download_array(*ex_, out, cloud.normals);
  }

  std::vector<float> scattered(const PreparedCloud& points, const exec::Buffer<float>& values,
                               ArrayView<const std::int32_t> signs, float factor) {
    auto out = exec::make_buffer<float>(*ex_, values.size());
    for_each(*ex_, "normals.scatter", values.size(),
             lines::Scatter{points.order.cview(), signs, values.cview(), factor, out.view()});
    std::vector<float> host;
    download_array(*ex_, out, host);
    return host;
  }

  std::shared_ptr<Exec> ex_;
};

}  // namespace pointskin::detail
