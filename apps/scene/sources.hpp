// Clouds and meshes that a scene is made of: files and generated shapes.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/io.hpp>

#include "scene/operations.hpp"

namespace pointskin::scene {

/// A part of the base of a scene: a file or a generated shape. One of `file` and `shape` is empty.
struct CloudSource {
  std::string file;              ///< absolute path
  std::string sha256;            ///< of the file when the document was written, 64 lower-case digits; empty: not known
  std::string shape;             ///< a name that bench::make_shape() knows
  std::int64_t points = 60'000;  ///< drawn from the shape
};

/// @param path  also relative to the working directory
CloudSource cloud_of_file(const std::string& path);

/// Whether clouds may come without normals. If some do, the merged cloud has none.
enum class MissingNormals { refused, allowed };

/// What became of a base cloud on the way in, for people: the caller says it, nothing is printed.
struct ReadFacts {
  std::int64_t not_finite = 0;       ///< points left out: a coordinate is not finite
  std::int64_t no_normal = 0;        ///< points left out: their normal has zero length
  std::vector<std::string> notices;  ///< one line each: vertices of a mesh that took the normals of its faces
};

/// Reads `paths` ("-" is stdin) and merges them (merge_into). A mesh whose vertices have no normals gives its vertices
/// with those of the faces around (add_vertex_normals), where normals must be. O(points).
/// @param notices  receives what should be told of that
/// @throws Error as read_cloud; no_normals if that is refused; empty_result if a merged cloud would have no points,
///         invalid_input if all were dropped
Cloud read_clouds(const std::vector<std::string>& paths, const ReadOptions& options, MissingNormals missing,
                  std::vector<std::string>& notices);

/// @param name  of the file, for the story
/// @throws Error empty_result if the cloud has no points, invalid_input if all were dropped on reading
void check_not_empty(const Cloud& cloud, const std::string& name);

/// Removes points whose normal has zero length and counts them in Cloud::dropped. @returns how many
/// @throws Error no_normals if the cloud has no normals, or none that is not zero
std::int64_t drop_zero_normals(Cloud& cloud);

/// The sources in their order, merged. Files are read as the commands read them, shapes are sampled with seed 1.
/// @throws Error as read_clouds
Cloud merge_sources(const std::vector<CloudSource>& sources, const ReadOptions& options, MissingNormals missing,
                    ReadFacts& facts);

/// The base cloud of a scene: the sources merged, without points whose normal has zero length.
/// @param missing  allowed: a cloud without normals stays whole, and Scene has no surface until they are estimated
/// @throws Error as read_clouds
Cloud load_base(const std::vector<CloudSource>& sources, const ReadOptions& options, MissingNormals missing,
                ReadFacts& facts);

/// Samples of the shape called `name`, of seed 1: always the same. @throws Error usage for another name
Cloud shape_cloud(const std::string& name, std::int64_t points);

/// Reads solids, and keeps the last few: a part that is dragged over the scene is read once. A file is read again when
/// its size or its time changed. Holds at most kKept solids. Not safe for two threads at once.
class Sources {
 public:
  static constexpr std::size_t kKept = 3;

  /// @param threads  that read files, 0: all
  explicit Sources(int threads = 0) : threads_(threads) {}

  /// A cloud or a mesh, as `pointskin boolean` reads its inputs: clouds with normals alone.
  /// @throws Error as read_cloud and read_mesh, no_normals, empty_result
  std::shared_ptr<const Solid> solid(const SolidSource& source);

  /// A part to insert; has whatever normals its file has. @throws Error as read_cloud
  std::shared_ptr<const Cloud> part(const SolidSource& source);

 private:
  int threads_;
  std::deque<std::pair<std::string, std::shared_ptr<const Solid>>> solids_;  ///< by what names them, newest first
  std::deque<std::pair<std::string, std::shared_ptr<const Cloud>>> parts_;
};

/// `solid` moved by `placement`: positions in double and then relative to an origin near them, normals by its rotation.
Solid placed(const Solid& solid, const Similarity& placement);

}  // namespace pointskin::scene
