// Surface reconstruction: oriented points in, watertight mesh out.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/device.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/error.hpp>
#include <pointskin/export.hpp>
#include <pointskin/field.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/normals.hpp>
#include <pointskin/progress.hpp>
#include <pointskin/warning.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

/// What happens where the surface meets the faces of the working cube.
enum class DomainFaces {
  closed,  ///< the cube's faces cap the surface: the mesh is always watertight
  open,    ///< the surface ends there in boundary edges
};

/// The field on the faces of the working cube.
enum class Boundary {
  free,            ///< the natural condition of the hats, no flux through the faces: surfaces may run into them
  neumann = free,  ///< the same thing
  dirichlet,       ///< the field is 0: the surface closes before it reaches them
};

/// The implicit function that a surface is a level set of.
enum class FieldKind {
  poisson,   ///< screened Poisson (Kazhdan & Hoppe 2013): about 1 inside, 0 outside
  distance,  ///< signed distance to the tangent planes of the nearest samples, in finest cells, positive inside
             ///< (Hoppe et al. 1992), with the sides of the solved field; passes through the samples, their noise
             ///< included
};

/// What is done about the normals that points come with.
enum class PointNormals {
  automatic,  ///< kept, byte for byte, where they are consistent; all turned where the cloud is inside out; repaired
              ///< where they are clearly wrong. RunReport::warnings says what was done
  given,      ///< taken as they are; RunReport::warnings says what is wrong with them
  repair,     ///< judged first, and turned and replaced where they are wrong (NormalMethod::automatic)
  estimate,   ///< made first, as Options::normal_estimation says; the points need none
};

/// What the implicit function is fitted to, and how.
struct SolveOptions {
  /// As `depth`: the deepest that spacing and noise of the points support and the memory holds (suggest_depth).
  static constexpr int kAutomaticDepth = 0;

  int depth = 8;  ///< octree depth D, in [1, 20], or kAutomaticDepth; the finest cells are cube / 2^D wide
  PointNormals point_normals = PointNormals::automatic;
  NormalOptions
      normal_estimation{};  ///< how normals are repaired or made; its `progress` and `confidence` do not count
  /// With `distance`, `screening`, `fixed_screening`, `iterations`, `samples_per_node` and `residuals` have no meaning
  /// and are not used; `boundary` must be free and `envelope` null. With `confidence` a sample's plane weighs by the
  /// length of its normal.
  FieldKind field = FieldKind::poisson;
  double screening = 2;  ///< weight of the point constraints, in [0, 1e6]; 0 is the unscreened problem of the paper
  bool fixed_screening = false;   ///< true: all samples weigh alike; false: samples that scatter across the surface
                                  ///< weigh less, those that agree more (0.05 to 6.5 times `screening`)
  int iterations = 8;             ///< relaxations of every level finer than 5, in [1, 1000]; the coarser ones
                                  ///< together have a multigrid cycle for every four of them
  double scale = 1.1;             ///< working cube / bounding cube of the points used, in [1, 100]
  double samples_per_node = 1.5;  ///< samples that two cell faces of a level should hold; in [0, 100]. Sparser ones are
                                  ///< splatted coarser, and where they hold less than 0.42 of it the surface keeps to
                                  ///< the level above; 0: all levels are used everywhere. Where clean samples lie
                                  ///< along bends a third of it will do, and very noisy ones are given twice as many
  bool confidence = false;        ///< true: a normal's length, relative to the mean length, is the weight of its point
  Boundary boundary = Boundary::free;
  /// A watertight mesh that the surface stays inside of, in world coordinates (its origin counts): the field is 0 at
  /// corners of the octree outside of it, and no vertex lies farther outside than the cube's side times 2^-23. Points
  /// outside are used, but not for the isovalue. Null: none. Must not change while runs or Fields use it.
  /// Costs a query of the distance for every corner near it, on the host (docs/algorithm.md, section 10).
  std::shared_ptr<const Mesh> envelope{};
  /// Not 0: the surface at this distance from that of the field, world units, outwards where positive, inwards where
  /// negative; round around edges, and the working cube grows where it must (docs/algorithm.md, section 14). The Field
  /// is then minus the signed distance to that surface, in finest cells. Finite; excludes `trim`, `density`,
  /// `weakness`, `attributes`, `envelope`, `isovalue` and open `domain_faces`.
  double offset = 0;
  bool keep_strays = false;  ///< true: stray points count, too (see Strays); the cube is made for all points
};

/// Which surface of an implicit function becomes a mesh, and what the mesh carries. One Field may be extracted again
/// and again with different ones.
struct ExtractOptions {
  /// As `trim`: the value that RunReport::warnings would name where the surface is far from the points or runs into the
  /// faces of the working cube, which then stay open; else off.
  static constexpr double kAutomaticTrim = -1;

  /// The value of the field that the surface lies at, finite, in the field's unit (Field). Unset: Field::isovalue().
  std::optional<double> isovalue{};
  bool normals = true;      ///< true: the mesh carries vertex normals, from the gradient of the field
  bool linear_fit = false;  ///< true: edge crossings by linear instead of rescaled quadratic interpolation
  DomainFaces domain_faces = DomainFaces::closed;
  double trim = 0;  ///< > 0: the mesh ends where samples lie 1.75 times farther apart than at the sparsest samples,
                    ///< this share of all; in [0, 1), or kAutomaticTrim; 0: off, the mesh is closed. 0.01 to 0.1 suit
                    ///< open scans
  double island_ratio = 0.001;  ///< with trim: connected pieces below this share of the surface's area change sides,
                                ///< islands are removed and pinholes stay closed; in [0, 1)
  bool largest = false;         ///< true: only the connected piece with the largest area stays, of closed meshes too
  double min_component =
      0;                 ///< connected pieces that are smaller are left out, of closed meshes too, cavities as well:
                         ///< >= 1: than so many triangles; in (0, 1): than this share of the whole area; 0: none
  bool density = false;  ///< true: the mesh carries "density", samples per unit of area (world units^-2)
  /// true: the mesh carries "weakness", in [0, 1]: where samples are sparser and the field flatter than at half of the
  /// samples, so that the topology is a guess (docs/algorithm.md, section 15); for find_problems(). Needs the field
  /// poisson.
  bool weakness = false;
  /// true: the mesh carries every attribute of the cloud in its type (docs/algorithm.md, section 9). Labels (is_label)
  /// are those of the nearest point that has one, exactly; all else is interpolated at the vertices, smoothly extended
  /// over holes, and rounded in integers. A point whose value is missing or not finite does not count for that
  /// attribute; with `confidence` the others count by their weight. An attribute that no point used has a value of is
  /// left out. An attribute whose name the mesh has itself (x, y,
  /// z, nx, ny, nz, with `density` also density, with `weakness` that), or that came before, gets `input_` in front of
  /// it.
  bool attributes = false;
};

/// How a run runs. Nothing of it changes a result.
struct RunOptions {
  bool residuals = false;  ///< true: measure the residual of every level before and after its solve
  /// What the run may take on its device, cloud and mesh on the host not counted: it does not start where the estimate
  /// is larger, and ends with over_limit where it comes to need more. 0: no limit.
  std::int64_t max_memory_bytes = 0;

  /// Called a few times per run from the calling thread; returning false cancels the run (Error interrupted).
  std::function<bool(const Progress&)> progress{};
};

/// Points to mesh: all options in one.
struct Options : SolveOptions, ExtractOptions, RunOptions {
  Options() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): what is not said has its default
  Options(const SolveOptions& solve, const ExtractOptions& extract = {}, const RunOptions& run = {})
      : SolveOptions(solve), ExtractOptions(extract), RunOptions(run) {}
};

struct LevelReport {
  int depth = 0;
  std::int64_t nodes = 0;     ///< cells of this depth
  std::int64_t unknowns = 0;  ///< corners solved for at this depth; 0 unless Options::residuals
  int iterations = 0;
  double residual_before = 0;  ///< 2-norm of b - A u over the unknowns; 0 unless Options::residuals
  double residual_after = 0;
};

/// What Options::trim did. All zero without it.
struct TrimReport {
  double quantile = 0;  ///< Options::trim, or what was taken for kAutomaticTrim; 0: nothing was cut
  double density = 0;   ///< samples per unit of area (world units^-2) below which the surface was cut away
  double area_before = 0, area_removed = 0;  ///< world units^2
  std::int64_t triangles_before = 0;
  std::int64_t triangles_removed = 0;  ///< wholly
  std::int64_t triangles_split = 0;    ///< by the cut, into one or two
  std::int64_t islands_removed = 0;    ///< kept pieces below Options::island_ratio, which were cut away, too
  std::int64_t holes_filled = 0;       ///< cut pieces below Options::island_ratio, which were kept
};

/// What Options::largest and Options::min_component did, or, without them, what was left out because there are outliers
/// and fewer than 24 samples lie on it. All zero where nothing was looked for.
struct PiecesReport {
  std::int64_t pieces = 0;             ///< connected pieces before
  std::int64_t pieces_removed = 0;     ///< of them
  std::int64_t triangles_removed = 0;  ///< with them
};

/// What Options::envelope did. All zero without it.
struct EnvelopeReport {
  std::int64_t samples_outside = 0;
  std::int64_t vertices_moved = 0;  ///< of the mesh, onto the envelope
  double farthest_move = 0;         ///< of such a vertex, world units
};

/// What Options::offset did. All zero without it.
struct OffsetReport {
  double cells = 0;             ///< the distance in finest cells of the cube that the offset surface was made in
  double cube_growth = 0;       ///< that cube / the working cube of the points, at least 1
  std::int64_t triangles = 0;   ///< of the surface that distances were measured to
  std::int64_t band_cells = 0;  ///< finest cells that the offset surface may pass through
  double ms = 0;                ///< the extraction of the surface included
};

/// What became of the normals that points came with.
enum class NormalsDone { kept, turned, repaired, estimated };

/// What a run did and what it cost. Times are milliseconds on the device's clock.
struct RunReport {
  std::vector<Warning> warnings;  ///< what should be looked at, the input first
  NormalsDone normals_done = NormalsDone::kept;
  std::optional<NormalReport> normals;  ///< where they were repaired or estimated
  std::int64_t points = 0;              ///< points used
  int fits = 1;                         ///< times that the field was solved for: 2 where normals were mended, or where
                                        ///< outliers had made the first cube too wide; 4 with both
  std::int64_t strays = 0;              ///< points left out because they are strays; 0 with Options::keep_strays
  std::vector<Vec3d> farthest_strays;   ///< up to 10 of them, world units, the farthest first
  int depth = 0;
  std::int64_t nodes = 0;           ///< cells of all depths
  std::vector<LevelReport> levels;  ///< depth 0 first
  double isovalue = 0;              ///< mean of the field over the samples but outliers; 0 for FieldKind::distance, and
                                    ///< minus OffsetReport::cells with Options::offset
  TrimReport trim;                  ///< with Options::trim
  PiecesReport pieces;              ///< with Options::largest or Options::min_component
  EnvelopeReport envelope;          ///< with Options::envelope
  OffsetReport offset;              ///< with Options::offset
  double upload_ms = 0, octree_ms = 0, splat_ms = 0, solve_ms = 0, extract_ms = 0, download_ms = 0;
  std::int64_t device_peak_bytes = 0;  ///< largest sum of buffers held at once in the space that ran the work
};

/// One of many reconstructions.
struct Reconstruction {
  Mesh mesh;  ///< empty with an error
  RunReport report;
  std::optional<Error> error;  ///< why there is no mesh
};

/// Fits fields to points and makes meshes of them, run after run, in a workspace. Not safe for two threads at once;
/// several reconstructors may live side by side, each with a workspace of its own or, on one thread, with a shared one.
///
/// After fork() the child may use what its parent made on the CPU and make more: the same bytes, but only the thread
/// that forked works, since the others are not there. While a process forks, no other of its threads may be in a call
/// of the library: the child would wait for locks of threads that it does not have. A GPU that the parent has used does
/// not answer in the child (Error device_unavailable).
class Reconstructor {
 public:
  /// @param workspace  a Device will do where nothing is to be shared
  /// @throws Error device_unavailable if the device does not answer, usage for a negative number of threads
  explicit Reconstructor(Workspace workspace = {});
  ~Reconstructor();
  Reconstructor(Reconstructor&&) noexcept;
  Reconstructor& operator=(Reconstructor&&) noexcept;

  /// Points to mesh: solve() and Field::extract() in one, which keeps less in memory than the two.
  /// @throws Error as solve() and Field::extract()
  Mesh reconstruct(const Cloud& cloud, const Options& options = {});
  Mesh reconstruct(const Cloud& cloud, const SolveOptions& solve, const ExtractOptions& extract = {},
                   const RunOptions& run = {});

  /// The same into a mesh of the caller, whose memory is used again: for frame after frame.
  /// @throws Error as above; the mesh is then valid but unspecified
  void reconstruct(const Cloud& cloud, const Options& options, Mesh& mesh);

  /// The same to a mesh in the memory of the workspace's device, from where write_mesh() takes it. With attributes, density
  /// or weakness the device holds them beside the field, which takes more of its memory. The same bytes, once downloaded.
  /// @throws Error as above
  DeviceMesh reconstruct_on_device(const Cloud& cloud, const Options& options = {});

  /// The same from points in the memory of the workspace's device to a mesh there: neither is copied. DevicePoints and
  /// DeviceMesh say who owns what and until when. Where normals are to be repaired or estimated the points go to the
  /// host and back. The same bytes as from the host.
  DeviceMesh reconstruct(const DevicePoints& points, const Options& options = {});

  /// Many clouds, each for itself: element i is what reconstruct() makes of clouds[i], the same bytes. On the CPU as many
  /// are worked on at once as there are threads, the largest first; a cloud so large that the others would have to wait for
  /// it, and any of more than a million points, has all threads to itself. A GPU works on up to twelve clouds at once, each on a
  /// stream of its own and under a thread of the host; one of more than 200,000 points has it to itself, and so has, in the end, one
  /// for which the others left no memory. Of several GPUs as one each has clouds of its own, up to twelve, and a cloud of more
  /// than 20 million points has all of them. Where Workspace::limit_memory has set a limit, a GPU takes one after the other.
  /// An Error that one cloud causes is kept with it and ends none of the others. Those that work at once have workspaces of
  /// their own, which on the CPU Workspace::limit_memory does not bind; they keep their memory for the next call (on a GPU up to
  /// a GiB together), and together they
  /// take that of as many runs. The bytes do not depend on the number of threads, but for Options::kAutomaticDepth where
  /// memory is short. Time as of the runs, shared by the threads.
  /// @param options  of every cloud. Options::max_memory_bytes counts for each by itself. Options::progress is told the
  ///                 share of the clouds that are done, in the phase "many", by one thread at a time but not always the same
  /// @throws Error usage (an option out of range), interrupted
  std::vector<Reconstruction> reconstruct_many(std::span<const Cloud> clouds, const Options& options = {});

  /// Fits the implicit function (SolveOptions::field; by default screened Poisson, Kazhdan & Hoppe 2013) on the octree
  /// of Zhou et al. 2010.
  /// Strays are left out and reported unless SolveOptions::keep_strays: they would take the cube's resolution from the
  /// rest. So are outliers beyond the box of all others, where they take 1/20 of it or more: that takes two fits.
  /// The Field shares this reconstructor's workspace and may outlive it. It keeps what any ExtractOptions need: beyond
  /// what reconstruct() takes, 24 bytes a point, the sample counts of its octree, and the attributes of the points.
  /// O(n log n + nodes). Deterministic: the same bytes for any thread count, any order of the points, CPU or GPU.
  /// @throws Error usage (an option out of range), no_normals (no normals, or all zero length),
  ///         invalid_input (points that are not finite, an attribute of another length, an envelope that is not
  ///         watertight), empty_result (no points, all at one place or outside of the envelope; an offset that leaves
  ///         nothing; an envelope within one cell), over_limit (memory or 32-bit indices), interrupted
  ///         (RunOptions::progress returned false)
  Field solve(const Cloud& cloud, const SolveOptions& options = {}, const RunOptions& run = {});

  /// The same from points in the memory of the workspace's device, which are not needed any more when it returns.
  Field solve(const DevicePoints& points, const SolveOptions& options = {}, const RunOptions& run = {});

  /// All of a run's options would be half unused here: what is extracted is said to Field::extract().
  Field solve(const Cloud& cloud, const Options& options) = delete;
  Field solve(const DevicePoints& points, const Options& options) = delete;

  /// Report of the last run.
  [[nodiscard]] const RunReport& report() const;

  [[nodiscard]] const Workspace& workspace() const;
  [[nodiscard]] const Device& device() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Estimate of the memory that Reconstructor::reconstruct() takes on its device, in bytes:
/// RunReport::device_peak_bytes within 15 %, from the bricks that the octree of these points would have on every level.
/// With Options::offset it is an upper bound for common shapes, 1.2 to 3 times what is taken.
/// With PointNormals::automatic it is that of a run whose normals are kept or turned: to doubt and repair them takes
/// more, and is left undone where Options::max_memory_bytes does not allow it. What a Field of solve() keeps beyond
/// that (see there) and the host's own copy of the cloud are not in it.
/// @param threads  CPU threads that count, 0: all
/// @throws Error usage (an option out of range), over_limit (a level beyond 32-bit node ids; counting itself would pass
///         Options::max_memory_bytes)
/// Takes less memory than it predicts and a fraction of the run's time. O(n log n + nodes log nodes).
std::int64_t estimate_device_bytes(const Cloud& cloud, const Options& options, int threads = 0);

/// The same from counts alone, for callers without the points: above the measured peak for common scans, by up to
/// several times, and too low for surfaces that fill their cube like a sponge.
std::int64_t estimate_device_bytes(std::int64_t points, const Options& options);

/// A depth that suits a cloud, and why.
struct DepthSuggestion {
  int depth = 0;       ///< in [1, 16]
  int supported = 0;   ///< what spacing and noise support; `depth` is less where the memory holds no more
  double spacing = 0;  ///< between samples of the surface, median over the points, world units
  double noise = 0;    ///< standard deviation of points across the surface, median, world units; what the surface bends
                       ///< over a few spacings is in it
};

/// The depth whose cells are as wide as the points resolve: sqrt(3/4) of their spacing, and no finer than twice their
/// noise (docs/algorithm.md, section 20), if an estimate of the run on `device` fits Options::max_memory_bytes, or
/// without such a limit the memory that the device has now. Normals are not needed.
/// @param options  those of the run; `depth` does not count
/// @throws Error usage (an option out of range), invalid_input (points that are not finite), empty_result (no points,
///         or all at one place), over_limit, device_unavailable
/// O(n log n): a sort, and an octree with about 1.5 points a cell. Deterministic but for the memory.
DepthSuggestion suggest_depth(const Cloud& cloud, const Options& options = {}, Device device = Device::cpu());

/// @throws Error usage, naming the option and its range, if an option is out of range
void validate(const Options& options);

/// "auto", "given", "repair", "estimate".
const char* name_of(PointNormals normals);

/// "kept", "turned", "repaired", "estimated".
const char* name_of(NormalsDone done);

}  // namespace pointskin
