#include "diagnose/warnings.hpp"

#include <algorithm>
#include <cmath>

#include "core/format.hpp"

namespace pointskin {
namespace diagnose {
namespace {

/// Samples that two faces of a cell hold where its level shows all that they know
/// (docs/decisions/0018-sparse-samples.md).
constexpr double kSamplesOfTwoFaces = 1.5;

/// A share in percent, with two digits.
std::string percent(double share) {
  const double value = 100 * share;
  if (value >= 9.95) return fmt::format("{:.0f} %", value);
  return value >= 0.995 ? fmt::format("{:.1f} %", value) : fmt::format("{:.2g} %", value);
}

}  // namespace

double Cube::cell(int level) const { return std::ldexp(side, -level); }

void warn_of_strays(std::int64_t count, const std::vector<Vec3d>& farthest, std::vector<Warning>& warnings) {
  if (count == 0) return;
  const Vec3d& at = farthest.front();
  warnings.push_back({WarningKind::strays, 0,
                      fmt::format("{} stray points far from all others are left out, the farthest at {:.9g} {:.9g} "
                                  "{:.9g}; use --keep-strays to keep them",
                                  count, at[0], at[1], at[2])});
}

void warn_of_attributes(const std::vector<std::string>& names, std::vector<Warning>& warnings) {
  if (names.empty()) return;
  warnings.push_back({WarningKind::attributes_missing, 0,
                      fmt::format("no point that is used has a value of {}: the mesh is without {}",
                                  fmt::join(names, ", "), names.size() == 1 ? "it" : "them")});
}

void warn_of_fit(const Findings& findings, const Cube& cube, std::vector<Warning>& warnings) {
  constexpr double kMost = 0.5;
  constexpr int kClearlyMore = 2;
  if (findings.off >= kMost)
    warnings.push_back(
        {WarningKind::off_surface, findings.off,
         fmt::format(
             "{} of the points lie away from the surface, by two cells of their spacing or more: are the normals "
             "right, and do the points belong to one surface? --normals repair mends normals",
             percent(findings.off))});
  if (findings.spacing <= 0) return;
  const int supported = supported_depth(std::ldexp(1.0, cube.depth), findings.spacing, findings.scatter);
  if (supported < cube.depth + kClearlyMore) return;
  const double beyond = 1 - std::ldexp(1.0, 2 * (cube.depth - supported));
  warnings.push_back(
      {WarningKind::coarse_depth, beyond,
       fmt::format("the points lie {:.3g} apart and hold detail for depth {}, depth {} shows cells of "
                   "{:.3g}: use --depth {}, or --depth auto",
                   findings.spacing * cube.cell(cube.depth), supported, cube.depth, cube.cell(cube.depth), supported)});
}

void warn_of_digits(double step, double spacing, std::vector<Warning>& warnings) {
  if (!(spacing > 0) || !(step >= kHarmlessStep * spacing)) return;
  warnings.push_back(
      {WarningKind::coarse_coordinates, std::min(1.0, step / spacing),
       fmt::format("the coordinates are float32 far from the origin, in steps of {:.3g} where points lie {:.3g} apart: "
                   "write them as double, or relative to a place near the points",
                   step, spacing)});
}

void warn_of_origin(const Vec3d& origin, double step, const char* what, double width, std::vector<Warning>& warnings) {
  if (!(width > 0) || !(step >= kHarmlessStep * width)) return;
  warnings.push_back({WarningKind::coarse_coordinates, std::min(1.0, step / width),
                      fmt::format("the coordinates are kept as float32 relative to {:.9g} {:.9g} {:.9g}, in steps of "
                                  "{:.3g} where {} {:.3g} apart: choose a place near the points, as --shift auto does",
                                  origin[0], origin[1], origin[2], step, what, width)});
}

void warn_of_surface(const Findings& findings, const Cube& cube, const Options& options,
                     std::vector<Warning>& warnings) {
  constexpr double kSomeCaps = 0.01;
  constexpr double kGoodPart = 0.15;
  if (options.trim != 0 || options.offset != 0) return;
  const bool closed = options.domain_faces == DomainFaces::closed;
  if (closed && findings.caps >= kSomeCaps)
    warnings.push_back({WarningKind::at_domain_faces, findings.caps,
                        fmt::format("the surface runs into the faces of the working cube, and {} of its area closes it "
                                    "there: --trim auto leaves that out, --boundary dirichlet closes it before; if the "
                                    "scan is closed, parts are inside out: --normals repair",
                                    percent(findings.caps))});
  if (findings.far >= kGoodPart)
    warnings.push_back(
        {WarningKind::far_from_points, findings.far,
         fmt::format("{} of the surface's area is farther than {:.3g} from all points: --trim {:g} cuts "
                     "that off (--trim auto finds the value)",
                     percent(findings.far), cube.cell(far_depth(findings, cube.depth)), fitting_trim(findings))});
}

void warn_of_parts(double flipped, std::vector<Warning>& warnings) {
  if (flipped < kNoticed) return;
  warnings.push_back(
      {WarningKind::normals_disagree, flipped,
       fmt::format("about {} of the normals point against those around them: --normals repair turns them",
                   percent(flipped))});
}

void warn_of_normals(const Findings& findings, NormalsVerdict verdict, std::vector<Warning>& warnings) {
  if (verdict == NormalsVerdict::inside_out) {
    warnings.push_back(
        {WarningKind::normals_inside_out, 1,
         "the normals point into what the points enclose, so the mesh is solid around it: --normals auto "
         "turns them; of a room seen from inside --trim auto leaves the walls alone"});
  } else if (findings.is_chance && findings.flipped >= kNoticed) {
    warn_of_parts(findings.flipped, warnings);
  } else if (verdict == NormalsVerdict::suspicious) {
    warnings.push_back({WarningKind::normals_disagree, findings.opposed,
                        fmt::format("{} of neighbouring points have opposed normals: parts of the points may be turned "
                                    "inside out; --normals repair finds out",
                                    percent(findings.opposed))});
  }
}

void warn_of_turning(std::vector<Warning>& warnings) {
  warnings.push_back(
      {WarningKind::normals_inside_out, 1,
       "the normals point into what the points enclose: all were turned; --normals given keeps them (of a "
       "room seen from inside, with --trim auto)"});
}

void warn_of_repair(const NormalReport& report, std::vector<Warning>& warnings) {
  const double given = std::max(1.0, static_cast<double>(report.given));
  const double flipped = static_cast<double>(report.flipped) / given;
  const double replaced = static_cast<double>(report.replaced) / given;
  warnings.push_back(
      {WarningKind::normals_disagree, flipped + replaced,
       fmt::format("the normals contradict each other: {} of them were turned and {} replaced; --normals "
                   "given keeps them",
                   percent(flipped), percent(replaced))});
}

int supported_depth(double cube, double spacing, double noise) {
  constexpr int kLeast = 4;
  constexpr int kMost = 16;
  const double by_spacing = spacing * std::sqrt(kSamplesOfTwoFaces / 2);  // the cell whose faces hold that many
  const double by_noise = 2 * noise;
  const double cell = std::sqrt(by_spacing * by_spacing + by_noise * by_noise);
  if (!(cell > 0)) return kMost;
  return std::clamp(static_cast<int>(std::lround(std::log2(cube / cell))), kLeast, kMost);
}

}  // namespace diagnose

std::optional<Warning> warning_of_doubts(const NormalReport& report) {
  constexpr double kMost = 0.5;
  const double share = static_cast<double>(report.doubtful) / std::max(1.0, static_cast<double>(report.points));
  if (share < kMost) return std::nullopt;
  return Warning{WarningKind::normals_doubtful, share,
                 fmt::format("{} of the estimated normals are doubtful: the points are too sparse or too noisy to "
                             "tell their sides; give the scanner's position with --sensor, or better points",
                             diagnose::percent(share))};
}

const char* name_of(WarningKind kind) {
  switch (kind) {
    case WarningKind::strays:
      return "strays";
    case WarningKind::normals_disagree:
      return "normals_disagree";
    case WarningKind::normals_inside_out:
      return "normals_inside_out";
    case WarningKind::normals_doubtful:
      return "normals_doubtful";
    case WarningKind::off_surface:
      return "off_surface";
    case WarningKind::at_domain_faces:
      return "at_domain_faces";
    case WarningKind::far_from_points:
      return "far_from_points";
    case WarningKind::coarse_depth:
      return "coarse_depth";
    case WarningKind::coarse_coordinates:
      return "coarse_coordinates";
    case WarningKind::attributes_missing:
      break;
  }
  return "attributes_missing";
}

}  // namespace pointskin
