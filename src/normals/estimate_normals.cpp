#include "normals/estimate_normals.hpp"

#include <cmath>
#include <utility>

#include "core/eigen3.hpp"
#include "core/matrix3.hpp"
#include "exec/this_space.hpp"
#include "normals/nearest_list.hpp"
#include "normals/neighbours.hpp"
#include "normals/select_nth.hpp"

namespace pointskin::normals {
namespace {

/// Points relative to the one in question, in units of the farthest one's distance.
template <int kMost>
struct Neighbourhood {
  int count = 0;
  double radius = 0;  // in the unit cube; 0: all are at one place
  Vec3d at[kMost + 1];
  double weight[kMost + 1];  // by distance alone
};

/// @param ids  ids[j] for j in [0, count), nearest first
template <int kMost, class Ids>
PSK_HD void gather(ArrayView<const Vec3f> positions, std::int64_t i, const Ids& ids, int count,
                   Neighbourhood<kMost>& out) {
  const Vec3d centre = to_double(positions[i]);
  out.count = 1;
  out.at[0] = {};
  double farthest = 0;
  for (int j = 0; j < count; ++j) {
    const Vec3d d = to_double(positions[ids[j]]) - centre;
    out.at[out.count++] = d;
    const double squared = dot(d, d);
    if (squared > farthest) farthest = squared;
  }
  out.radius = std::sqrt(farthest);
  if (!(out.radius > 0)) return;
  const double scale = 1 / out.radius;
  for (int j = 0; j < out.count; ++j) {
    out.at[j] = out.at[j] * scale;
    const double share = 1 - 0.75 * dot(out.at[j], out.at[j]);
    out.weight[j] = share * share;
  }
}

/// A plane with what its points say of it.
struct Plane {
  Eigen3 axes;  // the normal is axes.vectors[0]; values: mean squares
  Vec3d centre;
  double variance = 0;        // of the residuals, robust, per radius^2
  double whole_variance = 0;  // the same with nothing left out
};

/// Weighted principal components.
template <int kMost>
PSK_HD void fit_plane(const Neighbourhood<kMost>& points, const double* weight, Plane& plane) {
  double sum = 0;
  Vec3d centre{};
  for (int j = 0; j < points.count; ++j) {
    sum += weight[j];
    centre = centre + points.at[j] * weight[j];
  }
  plane.centre = centre * (1 / sum);
  Symmetric3 m;
  for (int j = 0; j < points.count; ++j) {
    const Vec3d d = points.at[j] - plane.centre;
    m = m + outer(d) * (weight[j] / sum);
  }
  plane.axes = eigen_of(m);
}

/// Median of squared residuals.
template <int kMost>
PSK_HD double median_square(const Neighbourhood<kMost>& points, const Plane& plane, double (&squares)[kMost + 1]) {
  double mixed[kMost + 1] = {};
  for (int j = 0; j < points.count; ++j) {
    const double r = dot(plane.axes.vectors[0], points.at[j] - plane.centre);
    squares[j] = r * r;
    mixed[j] = squares[j];
  }
  return select_nth(mixed, points.count, points.count / 2);
}

/// Principal components with nothing left out.
template <int kMost>
PSK_HD Plane fit_whole_plane(const Neighbourhood<kMost>& points) {
  Plane plane;
  fit_plane(points, points.weight, plane);
  const double whole = plane.axes.values[0];
  plane.whole_variance = whole > 0 ? whole : 0;
  return plane;
}

constexpr int kRobustRounds = 2;

/// Goes on from the plane of fit_whole_plane with Tukey's weights. @param weight  receives those of the last round
template <int kMost>
PSK_HD void refine_robustly(const Neighbourhood<kMost>& points, double (&weight)[kMost + 1], Plane& plane) {
  double squares[kMost + 1];
  for (int round = 0; round < kRobustRounds; ++round) {
    constexpr double kCutoff = 4.685 * 4.685 * 2.2;  // Tukey's constant for a variance from the median square
    const double limit = kCutoff * median_square(points, plane, squares) + 1e-12;
    for (int j = 0; j < points.count; ++j) {
      const double share = squares[j] < limit ? 1 - squares[j] / limit : 0.0;
      weight[j] = points.weight[j] * share * share;
    }
    fit_plane(points, weight, plane);
  }
  plane.variance = 2.2 * median_square(points, plane, squares);
}

/// What is on a sheet, of the radius, squared.
constexpr double kSheetNear = 0.12 * 0.12;

/// A plane near the point that some of its neighbours lie on, and the others far from: one of two sheets, or one side
/// of an edge. Planes through the point and two of its nearest are tried.
/// @param weight  receives those of the sheet's points
/// @returns false if the scatter has no such sheet
template <int kMost>
PSK_HD bool find_sheet(const Neighbourhood<kMost>& points, double variance, double (&weight)[kMost + 1], Plane& plane) {
  constexpr int kTried = 8;
  constexpr double kNear = kSheetNear;
  constexpr double kLeastShare = 0.4;      // of the weight
  constexpr double kFlat = 0.025 * 0.025;  // largest variance in the sheet, which noise alone does not come below
  constexpr double kClearer = 0.08;        // variance in the sheet / variance of all
  double best = 0;
  Vec3d best_normal{};
  for (int a = 1; a <= kTried && a < points.count; ++a) {
    for (int b = a + 1; b <= kTried && b < points.count; ++b) {
      const Vec3d n = cross(points.at[a], points.at[b]);
      const double squared = dot(n, n);
      if (!(squared > 0.05 * dot(points.at[a], points.at[a]) * dot(points.at[b], points.at[b]))) continue;
      double score = 0;
      for (int j = 0; j < points.count; ++j) {
        const double along = dot(n, points.at[j]);
        const double share = along * along / (squared * kNear);
        if (share < 1) score += points.weight[j] * (1 - share);
      }
      if (score <= best) continue;
      best = score;
      best_normal = n * (1 / std::sqrt(squared));
    }
  }
  double total = 0;
  for (int j = 0; j < points.count; ++j) total += points.weight[j];
  if (!(best > kLeastShare * total)) return false;
  plane.axes.vectors[0] = best_normal;
  plane.centre = {};
  double limit = 2 * kNear;
  for (int round = 0; round < 2; ++round) {
    double squares = 0;
    double sum = 0;
    for (int j = 0; j < points.count; ++j) {
      const double along = dot(plane.axes.vectors[0], points.at[j] - plane.centre);
      const double share = along * along / limit;
      weight[j] = share < 1 ? points.weight[j] * (1 - share) * (1 - share) : 0.0;
      squares += weight[j] * along * along;
      sum += weight[j];
    }
    plane.variance = squares / sum;
    fit_plane(points, weight, plane);
    limit = kNear;
  }
  return plane.variance < kClearer * variance && plane.variance < kFlat && plane.axes.values[1] > 0.02;
}

/// True if the points lie on two sides of the plane rather than scatter around it. Kurtosis less squared skewness is 1
/// for any two values (Pearson), 1.8 for the flattest noise, 3 for a normal distribution.
template <int kMost>
PSK_HD bool are_two_sheets(const Neighbourhood<kMost>& points, const Plane& plane) {
  constexpr double kTwoSheets = 1.5;
  double sum = 0;
  double mean = 0;
  for (int j = 0; j < points.count; ++j) {
    mean += points.weight[j] * dot(plane.axes.vectors[0], points.at[j] - plane.centre);
    sum += points.weight[j];
  }
  mean /= sum;
  double second = 0;
  double third = 0;
  double fourth = 0;
  for (int j = 0; j < points.count; ++j) {
    const double r = dot(plane.axes.vectors[0], points.at[j] - plane.centre) - mean;
    second += points.weight[j] * r * r;
    third += points.weight[j] * r * r * r;
    fourth += points.weight[j] * r * r * r * r;
  }
  return fourth * sum * second - third * third * sum < kTwoSheets * second * second * second;
}

/// z = c0 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2 over the tangent plane.
struct Quadric {
  double c[6];
  double variance = 0;  // of the residuals, weighted, per radius^2
  double plane_variance = 0;
  bool solved = false;
};

PSK_HD bool solve_cholesky(double (&a)[6][6], double (&b)[6]) {
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (int k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      if (i == j) {
        if (!(sum > 1e-10)) return false;
        a[i][i] = std::sqrt(sum);
      } else {
        a[i][j] = sum / a[j][j];
      }
    }
  }
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (int i = 5; i >= 0; --i) {
    for (int k = i + 1; k < 6; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return true;
}

template <int kMost>
PSK_HD Quadric fit_quadric(const Neighbourhood<kMost>& points, const Plane& plane, const double* weight) {
  Quadric out;
  double a[6][6] = {};
  double b[6] = {};
  double sum = 0;
  double squares = 0;
  for (int j = 0; j < points.count; ++j) {
    const Vec3d d = points.at[j];
    const double x = dot(plane.axes.vectors[2], d);
    const double y = dot(plane.axes.vectors[1], d);
    const double z = dot(plane.axes.vectors[0], d - plane.centre);
    const double row[6] = {1, x, y, x * x, x * y, y * y};
    for (int r = 0; r < 6; ++r) {
      for (int s = 0; s <= r; ++s) a[r][s] += weight[j] * row[r] * row[s];
      b[r] += weight[j] * row[r] * z;
    }
    sum += weight[j];
    squares += weight[j] * z * z;
  }
  double right[6];
  for (int r = 0; r < 6; ++r) {
    right[r] = b[r];
    out.c[r] = b[r];
  }
  out.solved = solve_cholesky(a, out.c);
  double explained = 0;
  for (int r = 0; r < 6; ++r) explained += out.c[r] * right[r];
  out.variance = (squares - explained) / sum;
  out.plane_variance = squares / sum;
  return out;
}

PSK_HD Vec3d with_largest_positive(const Vec3d& n) {
  const double x = n.x < 0 ? -n.x : n.x;
  const double y = n.y < 0 ? -n.y : n.y;
  const double z = n.z < 0 ? -n.z : n.z;
  const double largest = x >= y && x >= z ? n.x : (y >= z ? n.y : n.z);
  return largest < 0 ? n * -1.0 : n;
}

/// What is found at one point.
struct Line {
  Vec3f normal{0, 0, 1};
  float flatness = 0;
  float curvature = 0;
  double noise_unit = 0;  // scatter in the unit cube, without outliers
  bool is_sheet = false;  // what scatters is another sheet
};

/// Above this scatter, per radius, another sheet or more points may help. A plane's 16 samples without noise are far
/// below.
constexpr float kRough = 0.06F;

/// A quadric is taken where it leaves less than this share of what a plane leaves: few points always fit better.
PSK_HD double better_share(int count) { return count > kNeighbours + 1 ? 0.5 : 0.15; }

/// Line and curvature, once the plane is there. @param weight  those of the plane
template <int kMost>
PSK_HD void describe(const Neighbourhood<kMost>& points, const Plane& plane, const double* weight, Line& line) {
  Vec3d normal = plane.axes.vectors[0];
  const double middle = plane.axes.values[1];
  const double flatness = middle > 0 ? 1 - plane.axes.values[0] / middle : 0.0;
  // Of points in a line both are rounding, and the smallest may be far below 0.
  line.flatness = static_cast<float>(flatness > 1 ? 1.0 : flatness > 0 ? flatness : 0.0);
  double bend = 0;
  if (points.count > 8) {
    const Quadric q = fit_quadric(points, plane, weight);
    const double tilt = q.c[1] * q.c[1] + q.c[2] * q.c[2];
    if (q.solved && tilt < 1) {
      const double root = std::sqrt(1 + tilt);  // mean curvature of a graph with slopes c1, c2
      bend = -((1 + q.c[2] * q.c[2]) * q.c[3] - q.c[1] * q.c[2] * q.c[4] + (1 + q.c[1] * q.c[1]) * q.c[5]) /
             (root * root * root);
      if (q.variance < better_share(points.count) * q.plane_variance) {
        normal = normal - plane.axes.vectors[2] * q.c[1] - plane.axes.vectors[1] * q.c[2];
        normal = normal * (1 / root);
      }
    }
  }
  const Vec3d canonical = with_largest_positive(normal);
  const double sign = dot(canonical, normal) < 0 ? -1 : 1;
  line.normal = to_float(canonical);
  line.curvature = static_cast<float>(sign * bend / points.radius);
}

/// Line of points whose plane of fit_whole_plane is there.
template <int kMost>
PSK_HD Line fit_line(const Neighbourhood<kMost>& points, Plane& plane, double (&weight)[kMost + 1]) {
  Line line;
  refine_robustly(points, weight, plane);
  line.noise_unit = std::sqrt(plane.variance) * points.radius;
  line.is_sheet = points.count > kNeighbours + 1 && are_two_sheets(points, plane);
  describe(points, plane, weight, line);
  return line;
}

/// The sheet among the nearest points, if it goes on among the others: noise has none that does.
/// @param near      the nearest points
/// @param variance  what they leave of their plane
template <int kMost, class Ids>
PSK_HD bool fit_sheet(ArrayView<const Vec3f> positions, std::int64_t i, const Ids& ids, int count,
                      const Neighbourhood<kMost>& near, double variance, double (&weight)[kMost + 1], Line& line) {
  constexpr double kLeastShare = 0.3;
  if (!(near.radius > 0)) return false;
  Plane plane;
  if (!find_sheet(near, variance, weight, plane)) return false;
  int on_it = 0;
  for (int j = 0; j < count; ++j) {
    const Vec3d d = (to_double(positions[ids[j]]) - to_double(positions[i])) * (1 / near.radius) - plane.centre;
    const double along = dot(plane.axes.vectors[0], d);
    if (along * along < kSheetNear) ++on_it;
  }
  line.is_sheet = on_it > kLeastShare * count;
  if (line.is_sheet) describe(near, plane, weight, line);
  return line.is_sheet;
}

struct Out {
  ArrayView<Vec3f> normals;
  ArrayView<float> flatness, curvature, noise;
  PSK_HD void write(std::int64_t i, const Line& line) const {
    normals[i] = line.normal;
    flatness[i] = line.flatness;
    curvature[i] = line.curvature;
    noise[i] = line.is_sheet ? 0.0F : static_cast<float>(line.noise_unit);
  }
};

struct FitNear {
  ArrayView<const Vec3f> positions;
  ArrayView<const std::int32_t> neighbours;
  Out out;
  ArrayView<float> roughness;  // scatter across the plane / radius
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t* ids = neighbours.data + i * kNeighbours;
    int count = 0;
    while (count < kNeighbours && ids[count] >= 0) ++count;
    roughness[i] = 0;
    Neighbourhood<kNeighbours> points;
    gather(positions, i, ids, count, points);
    if (!(points.radius > 0) || count < 2) return out.write(i, {});
    double weight[kNeighbours + 1];
    Plane plane = fit_whole_plane(points);
    roughness[i] = static_cast<float>(std::sqrt(plane.whole_variance));
    out.write(i, fit_line(points, plane, weight));
  }
};

struct IsRough {
  ArrayView<const float> roughness;
  PSK_HD bool operator()(std::int64_t i) const { return roughness[i] > kRough; }
};

/// Grows the neighbourhood where the scatter does not grow with it: then it is noise and not shape.
struct FitFar {
  NearestSearch search;
  ArrayView<const std::int32_t> rough;
  ArrayView<const float> roughness;
  Out out;

  PSK_HD void operator()(std::int64_t r) const {
    // With the area doubled, an edge's scatter grows by 1.41 and curvature's by 2; noise's by 1, or by more where even
    // the larger neighbourhood is hardly wider than the noise.
    constexpr double kGrowth = 1.28;
    constexpr double kGrowthOfFour = 1.5;
    constexpr float kBall = 0.5F;  // flatness of neighbourhoods that lie in the noise
    const std::int32_t i = rough[r];
    NearestList<kMostNeighbours> list;
    search(i, list);
    if (list.count() <= 2 * kNeighbours) return;
    const ArrayView<const Vec3f> positions = search.points.positions;
    Neighbourhood<kMostNeighbours> points;
    double weight[kMostNeighbours + 1];
    gather(positions, i, list, kNeighbours, points);
    const double rough_near = roughness[i];
    Line line;
    if (fit_sheet(positions, i, list, list.count(), points, rough_near * rough_near, weight, line))
      return out.write(i, line);
    const double near = rough_near * points.radius;
    Plane plane;
    const auto scatter_of = [&](int count) {
      gather(positions, i, list, count, points);
      plane = fit_whole_plane(points);
      return std::sqrt(plane.whole_variance) * points.radius;
    };
    const double far = scatter_of(list.count());
    if (far <= kGrowthOfFour * near) return out.write(i, fit_line(points, plane, weight));
    const double middle = scatter_of(2 * kNeighbours);
    const bool is_noise = middle <= kGrowth * near;
    const bool is_ball = !is_noise && out.flatness[i] < kBall;
    if (far <= kGrowth * middle || is_ball) {
      scatter_of(list.count());
      out.write(i, fit_line(points, plane, weight));
    } else if (is_noise) {
      out.write(i, fit_line(points, plane, weight));
    } else {
      out.noise[i] = 0;  // some shape
    }
  }
};

/// Noise is everywhere, what looks like it at a rim or an edge is not: the median of the neighbours'.
struct ConfirmNoise {
  ArrayView<const std::int32_t> neighbours;
  ArrayView<const float> noise;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    constexpr int kRank = kNeighbours / 2;
    float least[kRank];
    int count = 0;
    for (int j = 0; j < kNeighbours; ++j) {
      const std::int32_t id = neighbours[i * kNeighbours + j];
      if (id < 0) break;
      const float value = noise[id];
      if (count == kRank && value >= least[kRank - 1]) continue;
      int place = count == kRank ? kRank - 1 : count++;
      for (; place > 0 && value < least[place - 1]; --place) least[place] = least[place - 1];
      least[place] = value;
    }
    out[i] = count == kRank ? least[kRank - 1] : 0.0F;
  }
};

}  // namespace

template <exec::Space Exec>
NormalLines estimate_lines(Exec& ex, const octree::SearchView& points, ArrayView<const std::int32_t> neighbours) {
  const std::int64_t n = points.positions.size;
  NormalLines result{exec::make_buffer<Vec3f>(ex, n), exec::make_buffer<float>(ex, n), exec::make_buffer<float>(ex, n),
                     exec::make_buffer<float>(ex, n)};
  auto roughness = exec::make_buffer<float>(ex, n);
  const Out out{result.normals.view(), result.flatness.view(), result.curvature.view(), result.noise.view()};
  for_each(ex, "normals.fit", n, FitNear{points.positions, neighbours, out, roughness.view()});
  const exec::Buffer<std::int32_t> rough = select(ex, "normals.rough", n, IsRough{roughness.cview()});
  for_each(ex, "normals.fit_far", rough.size(), FitFar{{points}, rough.cview(), roughness.cview(), out});
  for_each(ex, "normals.noise", n, ConfirmNoise{neighbours, result.noise.cview(), roughness.view()});
  result.noise = std::move(roughness);
  return result;
}

PSK_INSTANTIATE(estimate_lines);

}  // namespace pointskin::normals
