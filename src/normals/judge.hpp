// Which signs of a few patches fit together best.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pointskin::normals {

/// How the trial fields of patches act on each other: row a holds, for the field of patch a alone, the sum over the
/// samples of patch b of area times normal times minus the gradient. Symmetric but for the solver's error.
struct Couplings {
  std::size_t count = 0;
  std::vector<double> values;  ///< (count, count)
  [[nodiscard]] double operator()(std::size_t a, std::size_t b) const { return values[a * count + b]; }
  /// Both directions' mean, relative to what the smaller of the two does to itself; below 0.02 it is none.
  [[nodiscard]] double relative(std::size_t a, std::size_t b) const;
};

/// Where the trial fields of sets of patches put each other.
struct Sides {
  explicit Sides(std::size_t sets) : means(sets * sets), areas(sets), ties(sets * sets) {}
  std::vector<double> means;  ///< (sets, sets) row a: the mean of the field of set a alone over set b
  std::vector<double> areas;  ///< (sets)
  std::vector<double> ties;   ///< (sets, sets) what it costs to change the sign of a relative to b < a; the rest is 0
};

/// Signs that bring the field at every set nearest to 1/2: they minimise sum_b area_b (sum_a signs[a] means(a, b) -
/// 1/2)^2 and what ties cost. So what lies inside of a solid is a cavity, what lies in a cavity a solid, and of two
/// sheets that a thin wall consists of one has the other behind it. Of 14 sets all combinations are tried.
/// @param fixed  sets whose sign stays
/// @param signs  in: where to start; out: the best; those that are fixed stay
void choose_sides(const Sides& sides, const std::vector<bool>& fixed, std::vector<int>& signs);

/// Signs that maximise sum_ab signs[a] signs[b] c(a, b), the part of the normals' field that is a gradient: the signs
/// of a closed surface leave nothing else. All combinations are tried up to 14 free patches, else single changes are
/// made as long as one helps.
/// @param signs  in: where to start, 1 or -1; out: the best. Of two equal ones the first stays
/// @param fixed  patches whose sign stays
void choose_signs(const Couplings& couplings, const std::vector<bool>& fixed, std::vector<int>& signs);

}  // namespace pointskin::normals
