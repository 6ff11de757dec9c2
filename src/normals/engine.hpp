// What a NormalEstimator delegates to, one implementation a space.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <pointskin/normals.hpp>

namespace pointskin::detail {

/// What is known of sides: where points were seen from, relative to the cloud's origin, and what given normals decide.
struct Views {
  std::vector<Vec3d> sensors;  ///< relative to the cloud's origin
  std::vector<Vec3f> towards;  ///< (n) or none: from the point towards its sensor, any length
  bool turns_given = false;    ///< given normals that point into what the points enclose are turned
  [[nodiscard]] bool empty() const { return sensors.empty() && towards.empty(); }
};

class NormalEngine {
 public:
  virtual ~NormalEngine() = default;
  /// @param options  valid, with the method that is to be used
  virtual void orient(Cloud& cloud, const Views& views, const NormalOptions& options, NormalReport& report) = 0;
};

std::unique_ptr<NormalEngine> make_cpu_normal_engine(int threads);

/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::unique_ptr<NormalEngine> make_cuda_normal_engine(int index);

}  // namespace pointskin::detail
