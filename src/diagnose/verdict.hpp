// What the counts of a look mean: shares, and what they say of the normals.
#pragma once

#include <array>

#include "diagnose/counts.hpp"

namespace pointskin::diagnose {

/// Shares of the sparsest samples whose spacing is asked for: values of Options::trim to choose from.
inline constexpr std::array kTrims = {0.01, 0.02, 0.05};

/// Share of flipped normals from which on they are worth a word.
inline constexpr double kNoticed = 0.01;

/// Shares in [0, 1] unless said.
struct Findings {
  double opposed = 0;       ///< of pairs of neighbours, those whose normals are opposed as if one were flipped
  double flipped = 0;       ///< of samples, those that would be flipped if it had happened to single ones at random
  bool has_many = false;    ///< opposed pairs are not a handful
  bool is_chance = false;   ///< and as often this way round as that: flips, not sheets
  double faces_inside = 0;  ///< of the faces of the cube
  double openness = 0;      ///< length of the vector area / area: 0 for a closed surface
  double volume = 0;        ///< that the samples enclose, signed; of the cube
  double off = 0;           ///< of samples, those away from the surface
  double far = 0;           ///< of the surface's area, what is far from all samples
  double caps = 0;          ///< of the surface's area, what closes it on the faces of the cube
  double lonely = 0;        ///< samples far from all others, not a share
  double spacing = 0;       ///< of samples, median, finest cells; 0: not known
  std::array<double, kTrims.size()> sparsest{};  ///< spacing that these shares of the samples exceed
  double scatter = 0;                            ///< standard deviation of samples across the surface, finest cells
};

Findings findings_of(const Counts& counts);

/// What to think of given normals.
enum class NormalsVerdict {
  consistent,
  inside_out,  ///< they agree with each other and point into what is enclosed
  wrong,       ///< so many neighbours disagree that single ones are flipped
  suspicious,  ///< the surface is no boundary of a solid though it is closed, or a few neighbours disagree, as along
               ///< the rims of parts: they may be flipped as a whole
};

/// @param free_faces  the field may take any value on the faces of the cube
NormalsVerdict judge_normals(const Findings& findings, bool free_faces);

/// The surface ends at the faces of the cube, in part or all around.
bool runs_into_faces(const Findings& findings);

/// What is farther than this from all samples is far, finest cells: 4 typical spacings, 1.75 of those that one sample
/// in twenty exceeds (as trimming has it, src/reconstruct/trim_to_samples.hpp), 3 cells.
double far_spacing(const Findings& findings);

/// The value of Options::trim that cuts off what is far and nothing that need not go: the smallest of kTrims that does.
double fitting_trim(const Findings& findings);

/// The finest level with cells at least as wide as that.
int far_depth(const Findings& findings, int depth);

}  // namespace pointskin::diagnose
