// What two triangles of whole coordinates have in common, by linear programming in whole numbers: slow, and nothing
// like the method that is tested.
//
// Points of both triangles are pairs of barycentric coordinates (a, b) with sum a_i s_i = sum b_j t_j: a polytope in
// six variables, all >= 0, with five equations. Its corners are the solutions with linearly independent columns. What
// the triangles have in common is the convex hull of those corners' places.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <vector>

#include "mesh/triangle_contact.hpp"

namespace pointskin::test {

using Whole = __int128;
using WholePoint = std::array<int, 3>;

/// A triangle of whole coordinates, its corners named.
struct WholeTriangle {
  std::array<WholePoint, 3> corners;
  Triangle ids;
};

inline Whole size_of(Whole x) { return x < 0 ? -x : x; }

/// A corner of the polytope: coordinates[k] / divisor, divisor > 0; those of the first triangle come first.
struct Barycentric {
  std::array<Whole, 6> coordinates{};
  Whole divisor = 1;
};

class ExactContact {
 public:
  ExactContact(const WholeTriangle& s, const WholeTriangle& t) : s_(s), t_(t) {
    for (unsigned support = 1; support < 64; ++support)
      if (const auto corner = solve(support)) corners_.push_back(*corner);
  }

  [[nodiscard]] mesh_detail::Contact contact() const {
    if (!meet_beside_shared()) return mesh_detail::Contact::none;
    return insides_meet() ? mesh_detail::Contact::crossing : mesh_detail::Contact::touching;
  }

  /// Of different ids.
  [[nodiscard]] std::vector<WholePoint> shared_places() const {
    std::vector<WholePoint> places;
    std::vector<std::int32_t> seen;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t id = s_.ids[i];
      const auto holds = [id](const auto& ids) {
        for (const std::int32_t other : ids)
          if (other == id) return true;
        return false;
      };
      if (!holds(t_.ids) || holds(seen)) continue;
      seen.push_back(id);
      places.push_back(s_.corners[i]);
    }
    return places;
  }

 private:
  using Row = std::array<Whole, 7>;  // six columns and the right side

  static void reduce(Row& row) {
    Whole divisor = 0;
    for (const Whole x : row) divisor = greatest_common(divisor, size_of(x));
    if (divisor > 1)
      for (Whole& x : row) x /= divisor;
  }
  static Whole greatest_common(Whole a, Whole b) {
    while (b != 0) {
      const Whole rest = a % b;
      a = b;
      b = rest;
    }
    return a;
  }

  [[nodiscard]] std::array<Row, 5> equations() const {
    std::array<Row, 5> rows{};
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        rows[axis][k] = s_.corners[k][axis];
        rows[axis][3 + k] = -t_.corners[k][axis];
      }
      rows[3][k] = rows[4][3 + k] = 1;
    }
    rows[3][6] = rows[4][6] = 1;
    return rows;
  }

  /// The solution with these columns alone; none if they are dependent, or it is negative somewhere.
  [[nodiscard]] std::optional<Barycentric> solve(unsigned support) const {
    std::array<Row, 5> rows = equations();
    std::array<int, 6> row_of{};
    std::size_t rank = 0;
    for (std::size_t column = 0; column < 6; ++column) {
      if ((support >> column & 1) == 0) continue;
      std::size_t pivot = rank;
      while (pivot < 5 && rows[pivot][column] == 0) ++pivot;
      if (pivot == 5) return std::nullopt;
      std::swap(rows[rank], rows[pivot]);
      for (std::size_t r = 0; r < 5; ++r) {
        if (r == rank || rows[r][column] == 0) continue;
        const Whole mine = rows[r][column], top = rows[rank][column];
        for (std::size_t k = 0; k < 7; ++k) rows[r][k] = rows[r][k] * top - rows[rank][k] * mine;
        reduce(rows[r]);
      }
      row_of[column] = static_cast<int>(rank++);
    }
    for (std::size_t r = rank; r < 5; ++r)
      if (rows[r][6] != 0) return std::nullopt;
    return solution(rows, row_of, support);
  }

  static std::optional<Barycentric> solution(const std::array<Row, 5>& rows, const std::array<int, 6>& row_of,
                                             unsigned support) {
    Barycentric x;
    for (std::size_t column = 0; column < 6; ++column)
      if ((support >> column & 1) != 0) x.divisor *= size_of(rows[static_cast<std::size_t>(row_of[column])][column]);
    for (std::size_t column = 0; column < 6; ++column) {
      if ((support >> column & 1) == 0) continue;
      const Row& row = rows[static_cast<std::size_t>(row_of[column])];
      x.coordinates[column] = x.divisor / row[column] * row[6];
      if (x.coordinates[column] < 0) return std::nullopt;
    }
    return x;
  }

  /// Whether the place of a corner of the polytope is on the hull of at most two places.
  [[nodiscard]] bool is_within(const Barycentric& x, const std::vector<WholePoint>& places) const {
    if (places.empty()) return false;
    std::array<Whole, 3> from{}, along{};  // from places[0], times the divisor
    Whole forward = 0, length = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < 3; ++k) from[axis] += x.coordinates[k] * s_.corners[k][axis];
      from[axis] -= x.divisor * places[0][axis];
      along[axis] = places.back()[axis] - places[0][axis];
      forward += from[axis] * along[axis];
      length += x.divisor * along[axis] * along[axis];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
      if (from[b] * along[c] != from[c] * along[b]) return false;
      if (length == 0 && from[axis] != 0) return false;
    }
    return forward >= 0 && forward <= length;
  }

  [[nodiscard]] bool meet_beside_shared() const {
    const std::vector<WholePoint> places = shared_places();
    if (places.size() == 3) return true;
    for (const Barycentric& corner : corners_)
      if (!is_within(corner, places)) return true;
    return false;
  }

  static bool has_area(const WholeTriangle& t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
      const auto& [p, q, r] = t.corners;
      if ((q[b] - p[b]) * (r[c] - p[c]) != (q[c] - p[c]) * (r[b] - p[b])) return true;
    }
    return false;
  }

  /// The middle of all corners of a polytope is inside: no coordinate is 0 there unless it is 0 everywhere.
  [[nodiscard]] bool insides_meet() const {
    if (!has_area(s_) || !has_area(t_)) return false;
    std::array<bool, 6> positive{};
    for (const Barycentric& corner : corners_)
      for (std::size_t k = 0; k < 6; ++k) positive[k] = positive[k] || corner.coordinates[k] > 0;
    for (const bool one : positive)
      if (!one) return false;
    return true;
  }

  WholeTriangle s_, t_;
  std::vector<Barycentric> corners_;
};

}  // namespace pointskin::test
