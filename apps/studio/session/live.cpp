#include "live.hpp"

#include <utility>
#include <vector>

#include <pointskin/error.hpp>

#include "scene/frame_files.hpp"

namespace pointskin::studio {
namespace {

using Clock = std::chrono::steady_clock;

/// As fast as the simulated time runs.
constexpr std::chrono::microseconds kFrameTime{16'667};

}  // namespace

Json Live::start(const scene::JsonReader& reader) {
  reader.object({"scene", "particles", "free"});
  constexpr std::int64_t kDefault = 20'000, kMost = 4'000'000;
  const std::string scene = reader.has("scene") ? reader.at("scene").text() : "dam-break";
  const std::int64_t particles =
      reader.has("particles") ? reader.at("particles").whole_number(simulation::kFewestParticles, kMost) : kDefault;
  water_ = std::make_unique<Water>(scene, particles, services_.workspace);
  paused_ = false;
  free_ = reader.has("free") && reader.at("free").boolean();
  return water_->facts();
}

Json Live::fluid(const Request& request) {
  const scene::JsonReader reader = request.reader({"start", "push", "obstacle", "pause", "restart", "stop", "step"});
  if (reader.has("stop")) {
    water_.reset();
    return Json::object();
  }
  Json facts = Json::object();
  if (reader.has("start")) facts = start(reader.at("start"));
  if (water_ == nullptr) throw Error(ErrorCode::usage, "fluid: there is no water yet; start a scene first");
  if (reader.has("push")) {
    const scene::JsonReader list = reader.at("push");
    list.array();
    std::vector<simulation::Interaction> forces;
    for (std::size_t i = 0; i < list.size(); ++i) forces.push_back(force_of(list.at(i).value()));
    water_->set_forces(std::move(forces));
  }
  if (reader.has("obstacle")) water_->move_obstacle(to_floats(reader.at("obstacle").vector()));
  if (reader.has("pause")) paused_ = reader.at("pause").boolean();
  if (reader.has("restart")) water_->restart();
  if (reader.has("restart") || reader.has("step")) next_frame();
  return facts;
}

bool Live::next_frame() {
  if (!services_.audience.somebody_waits()) return false;
  const Mesh& mesh = water_->next_frame();
  return teller_.show_frame(mesh, water_->facts());
}

Json Live::open_sequence(const std::filesystem::path& pattern, double particle_radius) {
  std::vector<std::filesystem::path> files;
  for (const scene::FrameFile& frame : scene::find_frames(pattern.string(), {}, {})) files.emplace_back(frame.path);
  SequenceOptions options;
  options.particle_radius = particle_radius;
  sequence_ = std::make_unique<Sequence>(std::move(files), options, services_.workspace);
  shown_ = 0;
  return {{"frames", sequence_->size()},
          {"name", pattern.filename().string()},
          {"particle_radius", sequence_->particle_radius()}};
}

Json Live::close_sequence() {
  sequence_.reset();
  return Json::object();
}

Json Live::frame(std::int64_t index) {
  if (sequence_ == nullptr) throw Error(ErrorCode::usage, "frame: there is no sequence; open one first");
  const auto start = Clock::now();
  const bool was_kept = sequence_->has(index);
  const std::shared_ptr<const Mesh> mesh = sequence_->frame(index);
  shown_ = index;
  const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  const bool was_shown = teller_.show_frame(*mesh, {{"index", index}, {"kept", was_kept}, {"ms", {{"surface", ms}}}});
  return {{"index", index}, {"kept", was_kept}, {"shown", was_shown}};
}

bool Live::work_ahead() {
  if (water_ != nullptr && !paused_) {
    const Clock::time_point now = Clock::now();
    if (now < due_ && !free_) return false;
    due_ = std::max(due_ + kFrameTime, now - kFrameTime);  // frames that were missed are not made up for
    if (next_frame()) return true;
  }
  return sequence_ != nullptr && sequence_->make_ahead(shown_);
}

}  // namespace pointskin::studio
