#include "preview_cloud.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

#include "studio/wire/wire.hpp"

namespace pointskin::studio {
namespace {

/// The first `count` points of the even order, in the order of the cloud.
void keep_evenly(Cloud& cloud, std::int64_t count) {
  if (cloud.size() <= count) return;
  const std::vector<std::int64_t> order = wire::even_order(cloud.positions);
  std::vector<bool> keep(cloud.positions.size());
  for (std::int64_t i = 0; i < count; ++i) keep[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = true;
  keep_where(cloud, keep);
}

}  // namespace

const Cloud& PreviewCloud::cloud() {
  refresh();
  return cloud_;
}

bool PreviewCloud::prepare() {
  constexpr std::size_t kMostTriangles = 4'000'000;  // a cloud that is copied and sorted in a moment
  if (!desk_.has_scene() || (state_ == desk_.state_number() && is_final_)) return false;
  const std::size_t triangles = desk_.present().mesh().triangles.size();
  if (triangles == 0 || triangles > kMostTriangles) return false;
  Cloud whole = desk_.present().cloud();
  whole.attributes.clear();
  if (!is_measured_for(whole.size())) {
    try {
      measure(whole);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::interrupted) throw;
      state_.reset();
      return true;
    }
  }
  state_.reset();
  refresh();
  return true;
}

bool PreviewCloud::is_measured_for(std::int64_t points) const {
  return points < 2 * measured_size_ && measured_size_ < 2 * points;
}

Options PreviewCloud::options() {
  refresh();
  Options options = desk_.present().options();
  options.depth = options.depth == Options::kAutomaticDepth ? depth_ : std::min(options.depth, depth_);
  options.point_normals = PointNormals::given;
  options.keep_strays = true;
  options.attributes = false;
  return options;
}

void PreviewCloud::refresh() {
  if (state_ == desk_.state_number()) return;
  cloud_ = desk_.present().cloud();
  cloud_.attributes.clear();
  is_final_ = is_measured_for(cloud_.size());
  if (!is_final_) {
    points_ = std::min(cloud_.size(), kFewestPoints);
    depth_ = kFlattest;
  }
  keep_evenly(cloud_, points_);
  state_ = desk_.state_number();
}

/// From few points on, so that what is too slow costs little time.
void PreviewCloud::measure(const Cloud& whole) {
  const std::int64_t most = std::min(whole.size(), kMostPoints);
  state_.reset();      // cloud_ is used for it
  measured_size_ = 0;  // should this be interrupted, the next one measures again
  depth_ = kFlattest;
  points_ = std::min(whole.size(), kFirstPoints);
  double ms = tried(whole, points_, depth_);
  for (; ms > kMostMs && points_ / 2 >= kFewestPoints; ms = tried(whole, points_, depth_)) points_ /= 2;
  for (; 2 * ms < kMostMs && points_ < most; ms = tried(whole, points_, depth_)) points_ = std::min(2 * points_, most);
  if (2 * ms < kMostMs && tried(whole, points_, kDeepest) < kMostMs) depth_ = kDeepest;
  measured_size_ = whole.size();
}

double PreviewCloud::tried(const Cloud& whole, std::int64_t points, int depth) {
  cloud_ = whole;
  keep_evenly(cloud_, points);
  Options options = desk_.present().options();
  options.depth = depth;
  options.point_normals = PointNormals::given;
  options.keep_strays = true;
  options.progress = [this](const Progress&) { return !services_.queue.waiting(); };
  Reconstructor reconstructor(services_.workspace);
  reconstructor.reconstruct(cloud_, options);  // takes the memory
  const auto start = std::chrono::steady_clock::now();
  reconstructor.reconstruct(cloud_, options);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace pointskin::studio
