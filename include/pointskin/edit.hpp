// Reconstruction under the user's hand: strokes, removals and copied parts, one after another, each undone and redone.
// Source: Zhou et al. 2010, section 5.1 (user-guided surface reconstruction).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <pointskin/camera.hpp>
#include <pointskin/cloud.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

/// Where the normals of added points come from.
enum class GuideNormals {
  cloud,   ///< interpolated from the cloud's points around, weight 1 / distance^2
  stroke,  ///< orthogonal to view direction and stroke, to the right of the stroke; for strokes only
};

/// A region of the picture: all pixels inside of an odd number of these closed polygons, so that polygons in polygons
/// are holes. A rectangle and a lasso have one.
using Area = std::vector<std::vector<Pixel>>;

/// Adds points to guide the surface: a stroke is extruded along the view through the whole depth of the cloud, an area
/// is filled in volume. Layers of points are `interval` apart, and so are the points of a layer.
struct Guide {
  Camera camera;
  std::vector<Pixel> stroke;  ///< a polyline; one point is a line along the view. Empty: see area
  Area area;                  ///< used if there is no stroke
  double interval = 0;        ///< w, world units; 0: the width of the finest cells
  GuideNormals normals = GuideNormals::cloud;
  bool inside_only = true;  ///< points outside of the present surface are dropped
};

/// Removes the points that the view shows in an area, at any depth or in front only.
struct Remove {
  Camera camera;
  Area area;
  bool originals = false;  ///< false: only points that were added; true: those of the base cloud, too
  /// True: only points that the present surface does not hide from the eye. A point is hidden if its line of sight
  /// passes through the inside farther than two cells before it; cells are those of the field where the point is. In an
  /// orthographic view the eye is infinitely far away.
  bool front_layer = false;
};

/// Turns the normals of the points that the view shows in an area, of original points as well as of added ones.
struct Flip {
  Camera camera;
  Area area;
  /// True: only points that are in front. As Remove::front_layer, but only the surface itself hides points, not the
  /// inside, and only where there are points that carry it: wrong normals make the surface bulge before the very points
  /// that are to be turned.
  bool front_layer = false;
};

/// x -> scale R x + translation.
struct Similarity {
  double scale = 1;                                           ///< > 0
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row, proper
  Vec3d translation{0, 0, 0};                                 ///< world units
};

/// Adds a part of another cloud. None of its points is dropped.
struct Insert {
  static constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  std::shared_ptr<const Cloud> part;  ///< with normals; must not change while a session has the operation
  Vec3d lower{-kNoEnd, -kNoEnd, -kNoEnd}, upper{kNoEnd, kNoEnd, kNoEnd};  ///< only points in this box, in the part's
                                                                          ///< world coordinates, are copied
  Camera camera;         ///< with an area: a view of the part in its own world coordinates
  Area area;             ///< only points that this view shows in it are copied; empty: wherever they are
  Similarity placement;  ///< from the part's world coordinates to those of the base cloud
  bool snap = false;     ///< true: then moved rigidly onto the points near it (point-to-plane ICP)
  std::string source;    ///< where the part is from, for people and scripts; not used
};

using Operation = std::variant<Guide, Remove, Insert, Flip>;

/// Shape of a surface.
struct Topology {
  std::int64_t components = 0;
  std::int64_t genus = 0;  ///< handles of all components; of an open surface: of that with its holes closed by nothing,
                           ///< components - euler / 2 rounded down
  std::int64_t euler = 0;
};

/// What an operation did and what it cost.
struct StepReport {
  std::string operation;                ///< "guide", "remove", "insert" or "flip"
  std::int64_t added = 0, removed = 0;  ///< points
  std::int64_t flipped = 0;             ///< points whose normals were turned
  std::int64_t points = 0;              ///< after it
  std::int64_t triangles = 0;           ///< after it
  bool snapped = false;                 ///< Insert::snap found points to snap to
  bool warm = false;                    ///< the solve started from the field before
  Topology before, after;               ///< zero without EditOptions::topology
  double edit_ms = 0;                   ///< points added and removed
  double reconstruct_ms = 0;            ///< from there to the mesh on the host
  double total_ms = 0;                  ///< both; without measuring the topology
};

/// What an operation would do to the points: world coordinates are origin + positions. No attributes.
struct EditPreview {
  Cloud added;    ///< with their normals; of a flip: the points with their normals turned
  Cloud removed;  ///< as they are; of a flip: the points before they are turned
};

struct EditOptions {
  Options reconstruction;  ///< offset must be 0, residuals do not count; progress is called for every step
  bool topology = true;    ///< measure components and genus of every surface, on the host
  bool warm_start = true;  ///< solves start from the field before, with 3/4 of the iterations
  /// The base cloud is what EditSession::cloud() gave: its attribute "added" (uint8) says which points are original and
  /// which were added, and is no attribute of the surface. Original points alone decide on isovalue, cube and depths of
  /// guides, as in the session that the cloud is from. False: all points are original, whatever attributes there are.
  bool continued = false;
  /// Points keep their attributes for cloud(), whether the surface shows them (Options::attributes) or not.
  bool keep_attributes = false;
  int states_kept = 4;  ///< states held on the device for undo, besides the base; others are made again; >= 1
  /// Bytes that these and the base may take. Beyond it only the base and the last state are held, without what follows
  /// from their points, and not the last one either while the next is made; undoing more than one step then takes a
  /// reconstruction for every step from the base on. >= 0
  std::int64_t undo_bytes = std::int64_t{1} << 30;
};

/// A base cloud and a list of operations on it. The cloud, the field and the surface stay on the device from one
/// operation to the next; the isovalue is the mean over the base cloud's points alone.
///
/// Every state follows from the base cloud, the options and the operations up to it, so undo brings back the same bytes
/// and so does a replay, on any device and with any number of threads. Not safe for two threads at once.
class EditSession {
 public:
  /// Uploads and reconstructs the base cloud.
  /// @throws Error as Reconstructor::reconstruct, usage if an edit option is out of range, invalid_input if a continued
  ///         cloud does not say of every point what it is, or none is original
  explicit EditSession(const Cloud& base, const EditOptions& options = {}, Workspace workspace = {});
  ~EditSession();
  EditSession(EditSession&&) noexcept;
  EditSession& operator=(EditSession&&) noexcept;

  /// Appends an operation to those that are done, forgets those that were undone, and reconstructs.
  /// @throws Error usage (a camera, polygon or number that is not as described), empty_result (no points or no surface
  ///         would be left), over_limit (more than 2^31 - 1 points), no_normals; the session stays as it was
  /// O(points log points + candidates + nodes), as a reconstruction.
  const StepReport& apply(const Operation& operation);

  /// The points that apply() would add and remove, without a reconstruction; the session stays as it is. A removal of all
  /// points is shown, though apply() refuses it.
  /// @throws Error as apply, but for what only the surface after it would tell
  /// O(points + candidates), and what Insert::snap costs; only points that change are copied to the host.
  [[nodiscard]] EditPreview preview(const Operation& operation) const;

  /// Takes the last operation back. @returns false if there is none
  bool undo();
  /// Does the last operation that was taken back again. @returns false if there is none
  bool redo();

  /// The operations that are done, the first first. An interval of 0 in a guide is the number that was used.
  [[nodiscard]] std::vector<Operation> operations() const;
  /// What each of them did. Shape as operations().
  [[nodiscard]] std::vector<StepReport> steps() const;

  /// The present surface.
  [[nodiscard]] const Mesh& mesh() const;
  /// The present points, with the attribute "added" (0: original, 1: guide, 2: inserted part); an attribute of
  /// the base cloud with this name is left out. Base points come first, in their order; strays are left out as in a
  /// reconstruction.
  [[nodiscard]] Cloud cloud() const;

  [[nodiscard]] const Device& device() const;

  class Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointskin
