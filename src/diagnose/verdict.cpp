#include "diagnose/verdict.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::diagnose {
namespace {

double share(std::uint64_t part, std::uint64_t all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0;
}

/// The density that a share of the samples does not reach, samples on a finest cell's face; 0 without samples.
double density_at(const Counts& counts, double below) {
  std::uint64_t all = 0;
  for (const std::uint64_t n : counts.densities) all += n;
  if (all == 0) return 0;
  const double wanted = below * static_cast<double>(all);
  std::uint64_t seen = 0;
  int bin = 0;
  for (; bin + 1 < kDensityBins; ++bin) {
    seen += counts.densities[bin];
    if (static_cast<double>(seen) >= wanted) break;
  }
  return std::sqrt(static_cast<double>(DensityBin::value(bin)) * static_cast<double>(DensityBin::value(bin + 1)));
}

double spacing_at(const Counts& counts, double below) {
  const double density = density_at(counts, below);
  return density > 0 ? 1 / std::sqrt(density) : 0;
}

/// Pairs whose normals are opposed are flips as far as as many are apart as facing: sheets are all one or the other.
void find_disagreement(const Counts& counts, Findings& findings) {
  constexpr double kFewest = 24;
  const auto apart = static_cast<double>(counts.sums[kApart]);
  const auto facing = static_cast<double>(counts.sums[kFacing]);
  const auto abreast = static_cast<double>(counts.sums[kAbreast]);
  const double flips = 2 * std::min(apart, facing) + abreast;
  const double all = flips + static_cast<double>(counts.sums[kAlike]);
  if (!(all > 0)) return;
  findings.opposed = flips / all;
  findings.flipped = (1 - std::sqrt(std::max(0.0, 1 - 2 * findings.opposed))) / 2;
  findings.has_many = flips >= kFewest;
  findings.is_chance = findings.has_many && std::min(apart, facing) + abreast >= 0.6 * std::max(apart, facing);
}

/// The largest scatter of those measured over longer and longer steps: short ones stay within noise that is wider.
double scatter_of(const Counts& counts) {
  double variance = 0;
  for (int k = 0; k < kScatterSteps; ++k)
    if (counts.sums[kScatterPairs + k] > 0)
      variance =
          std::max(variance, fraction(counts.sums[kScatter + k]) / static_cast<double>(counts.sums[kScatterPairs + k]));
  return std::sqrt(variance);
}

}  // namespace

Findings findings_of(const Counts& counts) {
  const auto& sums = counts.sums;
  Findings findings;
  find_disagreement(counts, findings);
  findings.faces_inside = share(sums[kFacesInside], kAllFacePoints);
  const double area = fraction(sums[kArea]);
  const double x = fraction(sums[kVectorX]);
  const double y = fraction(sums[kVectorY]);
  const double z = fraction(sums[kVectorZ]);
  findings.openness = area > 0 ? std::sqrt(x * x + y * y + z * z) / area : 1;
  findings.volume = fraction(sums[kFlux]) / 3;
  findings.off = share(sums[kSamplesOff], sums[kSamplesSeen]);
  findings.far = share(sums[kFarSurface], sums[kSurface]);
  findings.caps = share(sums[kCaps], sums[kSurface]);
  findings.lonely = static_cast<double>(sums[kLonely]);
  findings.spacing = spacing_at(counts, 0.5);
  for (std::size_t i = 0; i < kTrims.size(); ++i) findings.sparsest[i] = spacing_at(counts, kTrims[i]);
  findings.scatter = scatter_of(counts);
  return findings;
}

NormalsVerdict judge_normals(const Findings& findings, bool free_faces) {
  constexpr double kWrong = 0.05;         // of single samples
  constexpr double kSuspicious = 0.0015;  // of pairs: the rims of flipped parts
  constexpr double kAllOfThem = 0.95;
  constexpr double kClosed = 0.1;
  constexpr double kSurelyClosed = 0.04;
  if (findings.has_many && findings.flipped >= kWrong) return NormalsVerdict::wrong;
  const bool encloses_outside = free_faces ? findings.faces_inside >= kAllOfThem : findings.openness < kClosed;
  if (encloses_outside && findings.volume < 0) return NormalsVerdict::inside_out;
  const bool is_cut = runs_into_faces(findings) && findings.faces_inside < kAllOfThem;
  const bool has_rims = findings.has_many && findings.opposed >= kSuspicious && (findings.is_chance || is_cut);
  const bool is_contradiction = is_cut && findings.openness < kSurelyClosed;  // closed surfaces leave the faces alone
  if (has_rims || is_contradiction) return NormalsVerdict::suspicious;
  return NormalsVerdict::consistent;
}

bool runs_into_faces(const Findings& findings) {
  constexpr double kSome = 0.005;
  return findings.faces_inside >= kSome;
}

double far_spacing(const Findings& findings) {
  return std::max({3.0, 4 * findings.spacing, 1.75 * findings.sparsest.back()});
}

int far_depth(const Findings& findings, int depth) {
  return std::clamp(depth - static_cast<int>(std::ceil(std::log2(far_spacing(findings)))), 1, depth);
}

double fitting_trim(const Findings& findings) {
  const double far = far_spacing(findings);
  for (std::size_t i = 0; i < kTrims.size(); ++i)
    if (1.75 * findings.sparsest[i] <= far) return kTrims[i];
  return kTrims.back();
}

}  // namespace pointskin::diagnose
