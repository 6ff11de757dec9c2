// Findings as sentences for people: how much, and what helps.
#pragma once

#include <pointskin/reconstruct.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "diagnose/verdict.hpp"

namespace pointskin::diagnose {

/// The working cube and its octree, in world units.
struct Cube {
  double side = 0;
  int depth = 0;

  [[nodiscard]] double cell(int level) const;
};

/// Points that were left out; nothing if none were.
/// @param farthest  world units
void warn_of_strays(std::int64_t count, const std::vector<Vec3d>& farthest, std::vector<Warning>& warnings);

/// Attributes that no point has a value of; nothing if there are none.
void warn_of_attributes(const std::vector<std::string>& names, std::vector<Warning>& warnings);

/// What is said of the field of a run: points off the surface, and more detail than the depth shows.
void warn_of_fit(const Findings& findings, const Cube& cube, std::vector<Warning>& warnings);

/// World coordinates are numbers of float `step` apart, next to points that are `spacing` apart, both in world units;
/// nothing if either is 0 or the steps are small beside the spacing.
void warn_of_digits(double step, double spacing, std::vector<Warning>& warnings);

/// Coordinates relative to `origin` are kept as floats `step` apart, next to what is `width` wide, "points lie" or "cells
/// are"; nothing if the steps are small beside it.
void warn_of_origin(const Vec3d& origin, double step, const char* what, double width, std::vector<Warning>& warnings);

/// Steps below this share of the spacing of the points do no harm: rounding to them moves a point by 4 % of the spacing.
inline constexpr double kHarmlessStep = 0.125;

/// What is said of the surface of a run, unless the options cut or close it already.
void warn_of_surface(const Findings& findings, const Cube& cube, const Options& options,
                     std::vector<Warning>& warnings);

/// What is said of given normals that stay as they are; nothing if they are consistent.
void warn_of_normals(const Findings& findings, NormalsVerdict verdict, std::vector<Warning>& warnings);

/// A share of the normals is flipped, in parts too small to repair unasked; nothing below kNoticed.
void warn_of_parts(double flipped, std::vector<Warning>& warnings);

/// All normals were turned the other way round.
void warn_of_turning(std::vector<Warning>& warnings);

/// Given normals were repaired without having been asked for.
void warn_of_repair(const NormalReport& report, std::vector<Warning>& warnings);

/// The depth that spacing and scatter support, for points whose samples and noise are known in units of `cube`.
int supported_depth(double cube, double spacing, double noise);

}  // namespace pointskin::diagnose
