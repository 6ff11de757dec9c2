// What can be done to a scene: the operations of an editing session, and those that make a new cloud or surface of it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include <nlohmann/json.hpp>

#include <pointskin/boolean.hpp>
#include <pointskin/cloud.hpp>
#include <pointskin/deform.hpp>
#include <pointskin/edit.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/normals.hpp>

namespace pointskin::scene {

/// Points or a closed mesh that an operation brings in.
using Solid = std::variant<Cloud, Mesh>;

/// Where a solid is from: a file, or a generated shape (bench/shapes). One of `file` and `shape` is empty.
struct SolidSource {
  std::string file;              ///< absolute path
  std::string shape;             ///< a name that bench::make_shape() knows
  std::int64_t points = 60'000;  ///< drawn from the shape, in [1, 100,000,000]
};

/// Bends the points (Deformer). The surface is that of Deformer::reconstruct().
struct Deform {
  Deformation deformation;
};

/// Combines the scene, A, with another solid, B (Booleans).
///
/// Points of A that are kept keep what they are (original, guide, inserted) and their attributes; points of B and
/// samples along creases are original ones, whose attributes are missing.
struct Combine {
  BooleanOp op = BooleanOp::unite;
  SolidSource with;
  Similarity placement;  ///< from B's world coordinates to those of the scene
  Creases creases = Creases::sampled;
  double coincidence_cells = 0.5;      ///< BooleanOptions::coincidence_cells
  std::shared_ptr<const Solid> solid;  ///< B as it was read, not yet placed; must not change. Null: Scene::apply reads
                                       ///< it, and the history keeps it, so that undo does not depend on files
};

/// Makes, mends or turns the normals of all points.
struct Orient {
  enum class What {
    estimate,  ///< NormalMethod::automatic, sensor, propagate or iterate, as `options` says
    repair,    ///< NormalMethod::repair
    turn,      ///< the sign of every normal is changed
  };
  What what = What::estimate;
  NormalOptions options;  ///< not used with `turn`; `progress` does not count, `time_limit_s` must be 0: a result must
                          ///< not depend on the machine's speed
};

/// Reconstructs with other options from here on; points stay as they are. In JSON the keys stand beside the `op`:
/// {"op": "options", "depth": 9}.
struct Configure {
  nlohmann::json options;  ///< an object with some of option_keys() alone, valid (read_options)
};

using SceneOperation = std::variant<Guide, Remove, Flip, Insert, Deform, Combine, Orient, Configure>;

/// "guide", "remove", "flip", "insert", "deform", "boolean", "orient" or "options": its `op` in JSON.
const char* name_of(const SceneOperation& operation);

/// True for guide, remove, flip and insert: what an editing session does, and what has a preview of points.
bool is_edit(const SceneOperation& operation);

/// An operation of an editing session as the library has it.
/// @throws Error internal for any other (see is_edit)
Operation edit_of(const SceneOperation& operation);

}  // namespace pointskin::scene
