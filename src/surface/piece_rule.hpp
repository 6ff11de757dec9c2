// Which connected pieces of a surface stay: what is summed up over each, and the rule that follows from all.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "surface/pieces.hpp"
#include "surface/trim_pieces.hpp"

namespace pointskin::surface {

/// Of a piece; sums in integers, which are the same in any order.
struct PieceExtent {
  static constexpr double kSampleUnits = 0x1p20;

  std::uint64_t area = 0;  ///< in trim's units
  std::uint64_t triangles = 0;
  std::uint64_t samples = 0;  ///< in units of 1 / kSampleUnits

  PSK_HD void add_triangle(double triangle_area) {
    area += trim::area_units(triangle_area);
    ++triangles;
  }
  /// @param density  samples per area at the triangle's first vertex
  PSK_HD void add_samples(double triangle_area, float density) {
    samples += static_cast<std::uint64_t>(kSampleUnits * triangle_area * static_cast<double>(density));
  }
  PSK_HD void add(const PieceExtent& other) {
    area += other.area;
    triangles += other.triangles;
    samples += other.samples;
  }
};

/// The whole, and its largest piece. Pieces are known by their first vertices.
struct WholeOfPieces {
  std::uint64_t area = 0, largest = 0;  ///< in trim's units: of all, and of the largest piece
  std::int64_t pieces = 0;
  std::int64_t largest_root = -1;  ///< its first vertex; -1: there is none
};
/// For reduce(), in any order. Of several pieces that are as large, the one of the first vertex is the largest.
struct AddWholes {
  PSK_HD WholeOfPieces operator()(const WholeOfPieces& a, const WholeOfPieces& b) const {
    const bool second = a.largest_root < 0 || b.largest > a.largest ||
                        (b.largest == a.largest && b.largest_root >= 0 && b.largest_root < a.largest_root);
    return {a.area + b.area, second ? b.largest : a.largest, a.pieces + b.pieces,
            second ? b.largest_root : a.largest_root};
  }
};

/// Which pieces stay.
struct PieceRule {
  std::int64_t only = -1;    ///< first vertex of the one that stays; -1: those that are large enough
  std::int64_t always = -1;  ///< of one that stays however small it is
  std::uint64_t least_area = 0, least_triangles = 0, least_samples = 0;

  [[nodiscard]] PSK_HD bool stays(std::int64_t root, const PieceExtent& extent) const {
    if (only >= 0) return root == only;
    return root == always ||
           (extent.area >= least_area && extent.triangles >= least_triangles && extent.samples >= least_samples);
  }
};

inline PieceRule rule_of(const PieceOptions& options, const WholeOfPieces& whole) {
  PieceRule rule;
  if (options.largest) rule.only = whole.largest_root;
  if (options.least_samples > 0) {
    rule.always = whole.largest_root;
    rule.least_samples = static_cast<std::uint64_t>(PieceExtent::kSampleUnits * options.least_samples);
  }
  if (options.least >= 1) rule.least_triangles = static_cast<std::uint64_t>(options.least);
  if (options.least > 0 && options.least < 1)
    rule.least_area = static_cast<std::uint64_t>(options.least * static_cast<double>(whole.area));
  return rule;
}

}  // namespace pointskin::surface
