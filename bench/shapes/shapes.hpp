// Shapes with a known implicit function, and area-uniform samples of their surfaces: ground truth for accuracy.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pointskin::bench {

/// F and its gradient at one point.
struct Sample {
  double value = 0;  ///< negative inside
  Vec3d gradient{};  ///< points outward on the surface
};

/// A point of a surface with its unit outward normal.
struct SurfacePoint {
  Vec3d position{}, normal{};
};

/// What a closed surface is made of.
struct Topology {
  std::int64_t components = 0;  ///< connected closed surfaces
  std::int64_t euler = 0;       ///< Euler number of all of them: 2 (components - genus)

  [[nodiscard]] std::int64_t genus() const { return components - euler / 2; }
};

class Random;

/// A solid {F < 0} inside the cube [-1.05, 1.05]^3. F is smooth near its surface F = 0, save on the edges of a shape
/// that draws its own samples. World units throughout.
class Shape {
 public:
  virtual ~Shape() = default;
  Shape() = default;
  Shape(const Shape&) = delete;
  Shape& operator=(const Shape&) = delete;

  /// F and grad F at `q`, in double, by closed formulas.
  [[nodiscard]] virtual Sample at(const Vec3d& q) const = 0;

  /// An upper bound of |F(x) - F(centre)| over the points x of the surface with |x - centre| <= radius; may be
  /// infinite.
  [[nodiscard]] virtual double variation(const Vec3d& centre, double radius) const = 0;

  /// An upper bound of |grad F| in all of space.
  [[nodiscard]] virtual double lipschitz() const { return 1; }

  [[nodiscard]] virtual Topology topology() const = 0;

  /// True if F is the signed distance from the surface, in all of space.
  [[nodiscard]] virtual bool is_distance() const { return true; }

  /// The point of the surface nearest to `q`. Only for shapes with is_distance(); see ClosestPoint for the others.
  [[nodiscard]] virtual SurfacePoint closest(const Vec3d& q) const;

  /// False near parts of the surface where no samples are drawn, as where no scanner looks.
  [[nodiscard]] virtual bool is_seen(const Vec3d& /*q*/) const { return true; }

  /// The area of shapes that draw their own samples, 0 for the others, whose samples come from a band around F = 0.
  [[nodiscard]] virtual double own_area() const { return 0; }

  /// A point drawn area-uniformly. Only for shapes with an own_area().
  /// @throws Error internal for the others
  [[nodiscard]] virtual SurfacePoint draw(Random& random) const;
};

/// Half the side of the cube that holds every shape.
inline constexpr double kHalfExtent = 1.05;

/// Names that make_shape() knows.
inline constexpr std::array<const char*, 8> kShapeNames = {"gyroid", "sphere", "torus",  "knot",
                                                           "plate",  "slab",   "nested", "hand"};

/// The shape called `name`:
///   gyroid  shell of half-thickness 0.4 in g around sin9x cos9y + sin9y cos9z + sin9z cos9x = g, cut by the unit ball
///   sphere  radius 1
///   torus   radii 0.7 and 0.25
///   knot    tube of radius 0.11 around a trefoil, with bumps 0.015 high
///   plate   a rectangle 1.8 by 1.2, 0.04 thick, with round rims
///   slab    a box of 1.8 by 1.2 by 0.04 with sharp edges
///   nested  a ball of radius 0.3 in the cavity, of radius 0.6, of a ball of radius 0.95
///   hand    palm and five fingers along y, of blended capsules. Index and middle finger are 0.035 apart near their
///           tips and not seen where they face each other, |x - 0.235| < 0.07 above y = 0.5: reconstructed from its
///           samples at depth 7 or 8, they grow together (genus 1) until strokes part them
/// NAME@1 and NAME@2 are such shapes turned by one of two fixed rotations (rotated.hpp).
/// @throws Error usage for any other name
std::unique_ptr<Shape> make_shape(const std::string& name);

/// First-order distance of `q` to the surface: F / |grad F|, positive outside.
double signed_distance(const Shape& shape, const Vec3d& q);

/// Newton steps along the gradient from `q`, where F is `sample`, until F / |grad F| is below 1e-13 (five digits below
/// float's spacing) or 30 steps are made. The point is near the closest one if `q` is near the surface.
SurfacePoint project(const Shape& shape, Vec3d q, Sample sample);

struct SamplingOptions {
  std::int64_t points = 500'000;  ///< > 0
  std::uint64_t seed = 1;
  double noise = 0;         ///< sigma of the Gaussian added to each coordinate, world units, >= 0
  double normal_noise = 0;  ///< sigma of the Gaussian added to each component of the unit normal, >= 0
  int threads = 0;          ///< CPU threads, 0: all
};

/// Points drawn area-uniformly and independently from the surface of `shape`, where it is seen, with unit outward normals.
///
/// Random points of the cube are kept when |F| / |grad F| < 0.001, then moved onto the surface by Newton steps. A
/// band of constant width holds the same volume over equal areas up to K eps^2 / 3 (K: Gaussian curvature), here below
/// 0.1 %. Cells of a grid that cannot meet the band are not drawn from. A shape with an own_area() draws by itself.
/// O(points). Deterministic for any number of threads: the random numbers are a function of seed and index.
/// @throws Error usage if an option is out of range
Cloud sample_surface(const Shape& shape, const SamplingOptions& options);

/// Area of the surface where it is seen, from `draws` draws of the same sampler. Standard error about area / sqrt(draws / 10).
double estimate_area(const Shape& shape, std::int64_t draws, std::uint64_t seed, int threads = 0);

}  // namespace pointskin::bench
