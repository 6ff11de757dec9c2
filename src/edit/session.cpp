#include "edit/session.hpp"

#include <pointskin/error.hpp>

#include <cmath>
#include <utility>

#include "edit/points.hpp"
#include "reconstruct/engine.hpp"

namespace pointskin {
namespace {

void require(bool holds, const char* story) {
  if (!holds) throw Error(ErrorCode::usage, story);
}

bool is_finite(const std::vector<Pixel>& pixels) {
  for (const Pixel& p : pixels)
    if (!std::isfinite(p[0]) || !std::isfinite(p[1])) return false;
  return true;
}

void check(const Area& area) {
  require(!area.empty(), "the operation has no area; give it polygons");
  for (const std::vector<Pixel>& polygon : area) {
    require(polygon.size() >= 3, "a polygon needs at least 3 corners");
    require(is_finite(polygon), "the corners of polygons must be finite");
  }
}

bool has_length(const std::vector<Pixel>& stroke) {
  for (const Pixel& p : stroke)
    if (p != stroke.front()) return true;
  return false;
}

void check(const Guide& guide) {
  validate(guide.camera);
  require(guide.stroke.empty() != guide.area.empty(), "a guide needs either a stroke or an area");
  require(is_finite(guide.stroke), "the points of a stroke must be finite");
  if (guide.stroke.empty()) check(guide.area);
  require(guide.interval >= 0 && std::isfinite(guide.interval), "the interval of a guide must be at least 0");
  require(guide.normals == GuideNormals::cloud || has_length(guide.stroke),
          "normals to the right of a stroke need a stroke with a length");
}

void check(const Remove& remove) {
  validate(remove.camera);
  check(remove.area);
}

void check(const Insert& insert) {
  require(insert.part != nullptr, "an inserted part needs a cloud");
  for (std::size_t a = 0; a < 3; ++a)
    require(insert.lower[a] <= insert.upper[a], "the box of a part must have its lower corner below its upper one");
  const Similarity& s = insert.placement;
  require(s.scale > 0 && std::isfinite(s.scale), "the scale of a part's placement must be above 0");
  for (const double t : s.translation) require(std::isfinite(t), "the translation of a part must be finite");
  Camera as_camera;  // whose view must be a rotation, too
  for (std::size_t i = 0; i < 9; ++i) as_camera.view[4 * (i / 3) + i % 3] = s.rotation[i];
  try {
    validate(as_camera);
  } catch (const Error&) {
    throw Error(ErrorCode::usage, "the rotation of a part's placement must be a rotation matrix, row by row");
  }
}

std::unique_ptr<EditSession::Impl> make_session(const Cloud& base, const EditOptions& options, const Device& device) {
  detail::validate_settled(options.reconstruction);
  require(options.reconstruction.offset == 0, "option offset must be 0 in an editing session");
  require(options.states_kept >= 1, "option states_kept must be at least 1");
  return device.kind == DeviceKind::cuda ? detail::make_cuda_session(base, options, device.index)
                                         : detail::make_cpu_session(base, options, device.threads);
}

}  // namespace

EditSession::EditSession(const Cloud& base, const EditOptions& options, const Device& device)
    : device_(device), impl_(make_session(base, options, device)) {}
EditSession::~EditSession() = default;
EditSession::EditSession(EditSession&&) noexcept = default;
EditSession& EditSession::operator=(EditSession&&) noexcept = default;

const StepReport& EditSession::apply(const Operation& operation) { return impl_->apply(operation); }
bool EditSession::undo() { return impl_->undo(); }
bool EditSession::redo() { return impl_->redo(); }
std::vector<Operation> EditSession::operations() const { return impl_->operations(); }
std::vector<StepReport> EditSession::steps() const { return impl_->steps(); }
const Mesh& EditSession::mesh() const { return impl_->mesh(); }
Cloud EditSession::cloud() const { return impl_->cloud(); }
const Device& EditSession::device() const { return device_; }

namespace detail {

void validate(const Operation& operation) {
  std::visit([](const auto& kind) { check(kind); }, operation);
}

Topology topology_of(const Mesh& mesh, int threads) {
  const MeshReport report = measure(mesh, threads);
  return {report.components,
          report.components - static_cast<std::int64_t>(std::floor(static_cast<double>(report.euler) / 2)),
          report.euler};
}

}  // namespace detail
}  // namespace pointskin
