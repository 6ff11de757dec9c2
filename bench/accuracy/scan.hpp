// A virtual range scanner: depth images of a scene from several places, with the faults of real ones.
#pragma once

#include <pointskin/cloud.hpp>

#include <cstdint>

#include "scene.hpp"

namespace pointskin::bench {

enum class ScanNormals {
  image,  ///< from the noisy depth image, as scanners do
  exact,  ///< of the surface, with noise
};

/// Lengths are in units of the diagonal of the scene's box.
struct ScanOptions {
  int views = 16;         ///< places of the camera, > 0
  int resolution = 300;   ///< pixels along each side of a depth image, >= 3
  double distance = 1.5;  ///< mean distance of the cameras from the centre of the box, <= 1000
  double spread = 0.4;    ///< distances are 1 - spread to 1 + spread times that: the nearer, the denser; in [0, 1);
                          ///< the nearest must be farther than 0.55
  double sigma = 0;       ///< of the noise along the ray, >= 0
  double misregistration = 0;  ///< sigma of a view's shift, and of what its turn moves at half the diagonal, >= 0
  double outliers = 0;         ///< share of the points that are outliers, in [0, 1)
  double grazing = 75;         ///< degrees; points whose normal is farther from the line of sight are dropped; (0, 90]
  ScanNormals normals = ScanNormals::image;
  double normal_noise = 0;  ///< sigma on each component of exact normals, >= 0
  int window = 1;           ///< normals from the image are fitted to (2 window + 1)^2 pixels; >= 1
  std::uint64_t seed = 1;
  int threads = 0;  ///< CPU threads, 0: all
};

/// Scans `scene`.
///
/// Cameras stand evenly around the scene and look at its centre, rolled at random. Each takes a perspective depth image
/// that holds the whole box: the first surface along the ray of each pixel, plus noise along the ray. Normals come from
/// the plane that fits the depths around a pixel best, without neighbours beyond a jump in depth, and face the camera.
/// The points of a view are then moved rigidly; the mean of these motions is none, as registration would have it.
/// Outliers are uniform in the box enlarged by a fifth, with normals in all directions.
/// O(views resolution^2 log t) for a mesh of t triangles. Deterministic for any number of threads.
/// @throws Error usage if an option is out of range; empty_result if nothing was seen
Cloud scan(const Scene& scene, const ScanOptions& options);

}  // namespace pointskin::bench
