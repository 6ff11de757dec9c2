#include "scene/stage.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <pointskin/boolean.hpp>
#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>
#include <pointskin/normals.hpp>

#include "scene/combine.hpp"
#include "scene/json_reader.hpp"
#include "scene/options.hpp"
#include "scene/sources.hpp"

namespace pointskin::scene {
namespace {

class Stopwatch {
 public:
  /// Milliseconds since construction or the last lap.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(start_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::int64_t bytes_of(const std::vector<Attribute>& attributes) {
  std::size_t bytes = 0;
  for (const Attribute& attribute : attributes) bytes += attribute.values.bytes();
  return static_cast<std::int64_t>(bytes);
}

void require_normals(const Stage& stage) {
  if (!stage.has_surface())
    throw Error(ErrorCode::no_normals, "the points have no normals; estimate them first (orient)");
}

/// B at its place. Its strays are left out as those of a base cloud are; those of A were when the scene began.
Solid second_operand(const Combine& combine, const Options& options, int threads, StepRecord& record) {
  std::shared_ptr<const Solid> solid = combine.solid;
  if (solid == nullptr) solid = Sources(threads).solid(combine.with);
  Solid moved = placed(*solid, combine.placement);
  auto* const cloud = std::get_if<Cloud>(&moved);
  if (cloud == nullptr || options.keep_strays) return moved;
  const Strays strays = find_strays(cloud->positions, threads);
  if (strays.points.empty()) return moved;
  std::vector<bool> keep(cloud->positions.size(), true);
  for (const std::int64_t stray : strays.points) keep[static_cast<std::size_t>(stray)] = false;
  keep_where(*cloud, keep);
  record.notes.push_back(fmt::format("{} stray points of the other solid are left out", strays.points.size()));
  return moved;
}

BooleanOperand operand_of(const Solid& solid) {
  if (const auto* cloud = std::get_if<Cloud>(&solid)) return *cloud;
  return std::get<Mesh>(solid);
}

void turn_all(Cloud& cloud) {
  for (Vec3f& normal : cloud.normals) normal = -normal;
}

void describe(const NormalReport& report, StepRecord& record) {
  record.flipped = report.flipped + report.replaced + (report.points - report.given);
  record.notes.push_back(fmt::format("normals by {}: {}", name_of(report.method), report.assumed));
  if (!report.settled) record.notes.emplace_back("the signs of the normals had not settled when the rounds ran out");
  if (const std::optional<Warning> doubts = warning_of_doubts(report)) record.notes.push_back(doubts->text);
}

}  // namespace

std::int64_t bytes_of(const Stage& stage) {
  std::int64_t bytes = 0;
  if (stage.cloud != nullptr)
    bytes += stage.cloud->size() * std::int64_t{2 * sizeof(Vec3f)} + bytes_of(stage.cloud->attributes);
  if (stage.mesh != nullptr) {
    const Mesh& mesh = *stage.mesh;
    bytes += static_cast<std::int64_t>((mesh.vertices.size() + mesh.normals.size()) * sizeof(Vec3f) +
                                       mesh.triangles.size() * sizeof(Triangle));
    bytes += bytes_of(mesh.attributes);
  }
  return bytes;
}

Options settled_options(const Stage& stage, const std::function<bool(const Progress&)>& progress) {
  Options options = stage.options;
  options.progress = progress;
  if (!stage.continued) return options;
  options.keep_strays = true;
  options.point_normals = PointNormals::given;
  return options;
}

Stage StageMaker::make(const Stage& before, const SceneOperation& operation, StepRecord& record) const {
  record.operation = scene::name_of(operation);
  Stage stage = std::visit(
      [&](const auto& kind) -> Stage {
        if constexpr (requires { make_from(before, kind, record); }) return make_from(before, kind, record);
        throw Error(ErrorCode::internal, "operations of an editing session make no stage");
      },
      operation);
  record.points = stage.cloud->size();
  record.triangles = static_cast<std::int64_t>(stage.mesh->triangles.size());
  record.total_ms = record.edit_ms + record.reconstruct_ms;
  return stage;
}

std::shared_ptr<const Mesh> StageMaker::reconstruct(const Stage& stage, StepRecord& record) const {
  auto mesh = std::make_shared<Mesh>();
  mesh->origin = stage.cloud->origin;
  if (!stage.has_surface()) return mesh;
  Stopwatch watch;
  Reconstructor reconstructor(workspace);
  Options options = settled_options(stage, progress);
  options.point_normals = PointNormals::given;
  reconstructor.reconstruct(*stage.cloud, options, *mesh);
  drop_added(mesh->attributes);
  for (const Warning& warning : reconstructor.report().warnings) record.notes.push_back(warning.text);
  record.reconstruct_ms = watch.lap();
  return mesh;
}

Stage StageMaker::make_from(const Stage& before, const Deform& deform, StepRecord& record) const {
  require_normals(before);
  Stopwatch watch;
  Deformer deformer(*before.cloud, settled_options(before, progress), workspace);
  deformer.deform(deform.deformation);
  record.edit_ms = watch.lap();
  auto mesh = std::make_shared<Mesh>();
  deformer.reconstruct(*mesh);
  drop_added(mesh->attributes);
  auto cloud = std::make_shared<const Cloud>(deformer.cloud());
  record.reconstruct_ms = watch.lap();
  record.added = deformer.report().inserted;
  record.removed = deformer.report().thinned;
  return {std::move(cloud), std::move(mesh), before.options, true};
}

Stage StageMaker::make_from(const Stage& before, const Combine& combine, StepRecord& record) const {
  require_normals(before);
  Stopwatch watch;
  const Solid other = second_operand(combine, before.options, workspace.device().threads, record);
  BooleanOptions options;
  options.reconstruction = settled_options(before, progress);
  options.reconstruction.attributes = false;  // booleans carry none to the mesh
  options.reconstruction.max_memory_bytes = 0;
  options.creases = combine.creases;
  options.coincidence_cells = combine.coincidence_cells;
  BooleanResult result = Booleans(workspace).combine(*before.cloud, operand_of(other), combine.op, options);
  carry_attributes(*before.cloud, result);
  const BooleanReport& report = result.report;
  record.added = report.b.kept + report.added;
  record.removed = report.a.dropped;
  record.flipped = report.a.flipped + report.b.flipped;
  record.reconstruct_ms = watch.lap();
  return {std::make_shared<const Cloud>(std::move(result.cloud)), std::make_shared<const Mesh>(std::move(result.mesh)),
          before.options, true};
}

Stage StageMaker::make_from(const Stage& before, const Orient& orient, StepRecord& record) const {
  Stopwatch watch;
  Cloud cloud = *before.cloud;
  if (orient.what == Orient::What::turn) {
    require_normals(before);
    turn_all(cloud);
    record.flipped = cloud.size();
  } else {
    NormalOptions options = orient.options;
    if (options.time_limit_s != 0)
      throw Error(ErrorCode::usage, "a scene's normals must not depend on time: time_limit_s must be 0");
    if (orient.what == Orient::What::repair) options.method = NormalMethod::repair;
    options.progress = progress;
    NormalEstimator estimator(workspace);
    estimator.orient(cloud, options);
    describe(estimator.report(), record);
  }
  record.edit_ms = watch.lap();
  Stage stage{std::make_shared<const Cloud>(std::move(cloud)), nullptr, before.options, before.continued};
  if (!stage.continued) stage.options.point_normals = PointNormals::given;
  stage.mesh = reconstruct(stage, record);
  return stage;
}

Stage StageMaker::make_from(const Stage& before, const Configure& configure, StepRecord& record) const {
  Stage stage = before;
  stage.options = read_options(JsonReader(configure.options, "options"), before.options);
  stage.mesh = reconstruct(stage, record);
  return stage;
}

}  // namespace pointskin::scene
