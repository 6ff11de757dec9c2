// Normals for clouds that have none, or wrong ones.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/export.hpp>
#include <pointskin/progress.hpp>
#include <pointskin/vector.hpp>
#include <pointskin/warning.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

/// What decides to which side a normal points.
enum class NormalMethod {
  automatic,  ///< sensor where the input says where it was seen from, repair where it has normals, else propagate;
              ///< closed parts whose given normals point into them are turned
  sensor,     ///< towards the sensor: NormalOptions::sensors, or attributes of the points
  propagate,  ///< consistent with the neighbours, patches and parts by trial reconstructions
  iterate,    ///< from a trial reconstruction, whose sides turn the normals, and again, until none turns
  repair,     ///< as most given normals around say; where these say nothing, as propagate
};

struct NormalOptions {
  NormalMethod method = NormalMethod::automatic;
  /// Where scanners stood, in world coordinates; a point was seen from the nearest. Empty: the attributes
  /// view_x, view_y, view_z or vx, vy, vz (from the point towards the scanner) or sensor_x, sensor_y, sensor_z (world
  /// coordinates of the scanner), where the cloud has all three.
  std::vector<Vec3d> sensors{};
  bool random_start = false;  ///< with `iterate`: signs at random instead of propagated ones
  std::uint64_t seed = 1;     ///< of these
  int max_rounds = 40;        ///< trial reconstructions at most, in [1, 1000]
  /// > 0: no further trial reconstruction is begun after so many seconds. The result then depends on the machine's
  /// speed; 0: no limit.
  double time_limit_s = 0;
  /// With `repair`: a given normal stays, byte for byte or with its sign changed, if it is within this angle of the
  /// line that the neighbours give; else it is replaced. Degrees, in [0, 90].
  double keep_within_degrees = 75;
  bool confidence = true;  ///< true: the cloud gets the attribute "confidence", in [0, 1]
  bool curvature = false;  ///< true: the cloud gets the attribute "curvature": mean curvature, 1 / world unit, > 0
                           ///< where the surface is convex
  /// Called a few times from the calling thread with phases "estimate", "propagate", "iterate"; false cancels.
  std::function<bool(const Progress&)> progress{};
};

/// What was done.
struct NormalReport {
  NormalMethod method = NormalMethod::propagate;  ///< the one that was used, never automatic
  std::string assumed;                            ///< what could not be known and was assumed, a sentence for people
  std::int64_t points = 0;
  std::int64_t given = 0;       ///< points that came with a normal
  std::int64_t kept = 0;        ///< of them, byte for byte
  std::int64_t flipped = 0;     ///< of them, with the sign changed
  std::int64_t replaced = 0;    ///< of them, by the estimated normal
  std::int64_t doubtful = 0;    ///< points with a confidence below 1/2
  std::int64_t patches = 0;     ///< within which neighbours agree
  std::int64_t components = 0;  ///< of the graph of neighbours
  std::int64_t turned = 0;      ///< patches or components whose sign a trial reconstruction has changed
  int rounds = 0;               ///< trial reconstructions
  bool settled = true;          ///< false: rounds or time ran out before the signs stopped changing
  double enclosing = 0;  ///< mean of the trial field at the points, 1/2 for a closed surface with right signs; near
                         ///< 0 where inside and outside are a guess
  double estimate_ms = 0, propagate_ms = 0, iterate_ms = 0, total_ms = 0;
  std::int64_t device_peak_bytes = 0;
};

/// Estimates and orients normals on a device. Reused cloud after cloud; not safe for two threads at once.
class NormalEstimator {
 public:
  /// @throws Error device_unavailable, usage as Reconstructor
  explicit NormalEstimator(Workspace workspace = {});
  ~NormalEstimator();
  NormalEstimator(NormalEstimator&&) noexcept;
  NormalEstimator& operator=(NormalEstimator&&) noexcept;

  /// Gives `cloud` outward unit normals; positions and other attributes stay. Given normals that are kept stay as they
  /// are. Every point gets one, strays too. Memory: estimate_normals_device_bytes, 370 to 1200 bytes a point. Sources:
  /// docs/algorithm.md, section 19. Deterministic: the same bytes for any thread count, any order of the points (points
  /// alike in position and normal may be exchanged), CPU or GPU, unless NormalOptions::time_limit_s cuts it short. O(n
  /// log n), and about 4 solves as Reconstructor's at a depth of log4(n / 1.5).
  /// @throws Error usage (an option out of range; sensor without one), no_normals (repair without normals),
  ///         invalid_input (points or normals that are not finite), empty_result (fewer than 3 points, or all at one
  ///         place), over_limit, interrupted
  void orient(Cloud& cloud, const NormalOptions& options = {});

  /// Report of the last run.
  [[nodiscard]] const NormalReport& report() const;
  [[nodiscard]] const Device& device() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// WarningKind::normals_doubtful where half of the points or more are doubtful, with their share; else none.
std::optional<Warning> warning_of_doubts(const NormalReport& report);

/// Device memory that NormalEstimator::orient takes for `cloud`, bytes: from what it measures
/// (NormalReport::device_peak_bytes) to 1.6 times that. Positions must be finite. Host, time, memory and errors as
/// estimate_device_bytes.
std::int64_t estimate_normals_device_bytes(const Cloud& cloud, int threads = 0);

/// @throws Error usage if an option is out of range
void validate(const NormalOptions& options);

/// "propagate" and so on; "auto" is automatic.
const char* name_of(NormalMethod method);

/// True if the points say where they were seen from, by attributes (see NormalOptions::sensors).
bool has_view_attributes(const Cloud& cloud);

}  // namespace pointskin
