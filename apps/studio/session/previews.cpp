#include "previews.hpp"

#include <chrono>
#include <utility>
#include <variant>
#include <vector>

#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>
#include <pointskin/reconstruct.hpp>

#include "classes_of_points.hpp"
#include "ms_since.hpp"
#include "scene/options.hpp"
#include "scene/sources.hpp"
#include "studio/wire/wire.hpp"

namespace pointskin::studio {
namespace {

using Clock = std::chrono::steady_clock;

/// Ends a run as soon as something newer waits.
std::function<bool(const Progress&)> stopping(const JobQueue& queue) {
  return [&queue](const Progress&) { return !queue.should_stop(); };
}

BooleanOperand operand_of(const scene::Solid& solid) {
  if (const auto* mesh = std::get_if<Mesh>(&solid)) return *mesh;
  return std::get<Cloud>(solid);
}

}  // namespace

Json Previews::operation(const nlohmann::json& json) {
  const scene::SceneOperation operation = desk_.operation_of(json);
  if (is_edit(operation)) return points(operation);
  if (const auto* deform = std::get_if<scene::Deform>(&operation)) return bent(*deform);
  if (const auto* combine = std::get_if<scene::Combine>(&operation)) return combined(*combine);
  throw Error(ErrorCode::usage, std::string("preview: there is none of '") + name_of(operation) + "'");
}

Json Previews::points(const scene::SceneOperation& operation) {
  const EditPreview preview = desk_.present().preview(operation);
  teller_.show_ghosts(preview.added, preview.removed);
  is_shown_ = true;
  return {{"added", preview.added.size()}, {"removed", preview.removed.size()}};
}

Json Previews::show(const Mesh& mesh, int depth, double ms) {
  MeshFacts facts;
  facts.preview = true;
  facts.depth = depth;
  facts.ms = {{"total", ms}};
  is_shown_ = true;
  const std::uint64_t version = teller_.show(mesh, facts);
  return {{"version", version}, {"triangles", mesh.triangles.size()}, {"depth", depth}};
}

void Previews::prepare_deformer() {
  if (deformer_ != nullptr && deformer_state_ == desk_.state_number()) return;
  deformer_.reset();
  const bool is_fast = desk_.last_ms() < kFastEnoughMs;
  Options options = cloud_.options();
  if (is_fast) options.depth = desk_.present().options().depth;
  options.progress = stopping(services_.queue);
  deformer_ =
      std::make_unique<Deformer>(is_fast ? desk_.present().cloud() : cloud_.cloud(), options, services_.workspace);
  deformer_state_ = desk_.state_number();
  deformer_depth_ = options.depth;
}

Json Previews::bent(const scene::Deform& deform) {
  const Clock::time_point start = Clock::now();
  prepare_deformer();
  deformer_->deform(deform.deformation);
  deformer_->reconstruct(mesh_);
  return show(mesh_, deformer_depth_, ms_since(start));
}

Json Previews::combined(const scene::Combine& combine) {
  const Clock::time_point start = Clock::now();
  BooleanOptions options;
  options.reconstruction = cloud_.options();
  options.reconstruction.progress = stopping(services_.queue);
  options.creases = combine.creases;
  options.coincidence_cells = combine.coincidence_cells;
  const scene::Solid b = scene::placed(*combine.solid, combine.placement);
  const Cloud& a = cloud_.cloud();
  Booleans booleans(services_.workspace);
  const BooleanResult result = booleans.combine(a, operand_of(b), combine.op, options);
  std::vector<const Cloud*> parts = {&a};
  if (const auto* cloud = std::get_if<Cloud>(&b)) parts.push_back(cloud);
  ClassedPoints classed = classes_of_points(parts, result.cloud);
  const auto part_json = [](const BooleanPart& part) {
    return Json{{"kept", part.kept}, {"flipped", part.flipped}, {"dropped", part.dropped}};
  };
  const Json counts = {{"a", part_json(result.report.a)}, {"b", part_json(result.report.b)}};
  teller_.show_tinted(classed.points, std::move(classed.classes), counts);
  Json reply = show(result.mesh, options.reconstruction.depth, ms_since(start));
  reply.update(counts);
  return reply;
}

Json Previews::options(const nlohmann::json& patch) {
  const Clock::time_point start = Clock::now();
  Options options = scene::read_options({patch, "patch"}, cloud_.options());
  const Options limits = cloud_.options();
  options.depth = std::min(options.depth, limits.depth);
  if (options.depth == Options::kAutomaticDepth) options.depth = limits.depth;
  options.progress = stopping(services_.queue);
  Reconstructor reconstructor(services_.workspace);
  reconstructor.reconstruct(cloud_.cloud(), options, mesh_);
  return show(mesh_, options.depth, ms_since(start));
}

Json Previews::end() {
  forget();
  if (std::exchange(is_shown_, false)) {
    teller_.hide_ghosts();
    desk_.show_mesh();
  }
  return Json::object();
}

void Previews::forget() {
  deformer_.reset();
  mesh_ = {};
}

}  // namespace pointskin::studio
