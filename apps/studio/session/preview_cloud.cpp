#include "preview_cloud.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

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
  if (!desk_.has_scene() || state_ == desk_.state_number()) return false;
  const std::size_t triangles = desk_.present().mesh().triangles.size();
  if (triangles == 0 || triangles > kMostTriangles) return false;
  refresh();
  return true;
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
  state_ = desk_.state_number();
  keep_evenly(cloud_, kMostPoints);
  depth_ = kDeepest;
  while (measured_ms() > kMostMs) {
    if (depth_ > kFlattest)
      --depth_;
    else if (cloud_.size() / 2 >= kFewestPoints)
      keep_evenly(cloud_, cloud_.size() / 2);
    else
      break;
  }
}

double PreviewCloud::measured_ms() {
  Options options = desk_.present().options();
  options.depth = depth_;
  options.point_normals = PointNormals::given;
  options.keep_strays = true;
  Reconstructor reconstructor(services_.workspace);
  reconstructor.reconstruct(cloud_, options);  // takes the memory
  const auto start = std::chrono::steady_clock::now();
  reconstructor.reconstruct(cloud_, options);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace pointskin::studio
