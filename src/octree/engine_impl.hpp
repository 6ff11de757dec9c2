#pragma once

#include <pointskin/error.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "octree/engine.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "octree/search.hpp"

namespace pointskin::octree {
namespace engine {

/// The tie break of a public tree: points with equal keys keep the caller's order.
struct ById {
  ArrayView<std::uint64_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = static_cast<std::uint64_t>(i); }
};

struct Locate {
  OctreeView tree;
  ArrayView<const Vec3f> queries;
  ArrayView<OctreeLeaf> out;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f q = queries[i];
    const Leaf leaf = locate(tree, point_key(q.x, q.y, q.z), tree.depth);
    out[i] = {leaf.depth, leaf.cell};
  }
};

/// Copies an array of a space into a vector.
template <class T, exec::Space Exec>
std::vector<T> to_vector(Exec& ex, const exec::Buffer<T>& buffer) {
  std::vector<T> out(static_cast<std::size_t>(buffer.size()));
  copy_to_host(ex, buffer.cview(), out.data());
  return out;
}

}  // namespace engine

template <exec::Space Exec>
class OctreeOn final : public Octree::Impl {
 public:
  OctreeOn(std::unique_ptr<Exec> ex, const std::vector<Vec3f>& positions, const OctreeOptions& options)
      : ex_(std::move(ex)) {
    if (positions.size() > std::size_t{std::numeric_limits<std::int32_t>::max()})
      throw Error(ErrorCode::over_limit, "the cloud has more than 2^31 - 1 points; thin it or split it");
    const exec::Buffer<Vec3f> world = upload(positions);
    frame_ = fit_frame(*ex_, world.cview(), options.scale);
    const exec::Buffer<Vec3f> unit = to_unit(world);
    auto ties = exec::make_buffer<std::uint64_t>(*ex_, unit.size());
    for_each(*ex_, "octree.ties", ties.size(), engine::ById{ties.view()});
    SortedPoints sorted = sort_points(*ex_, unit.cview(), ties.cview());
    data_ = build_octree(*ex_, sorted.keys.cview(), options.depth);
    order_ = std::move(sorted.order);
    positions_ = exec::make_buffer<Vec3f>(*ex_, unit.size());
    exec::gather(*ex_, unit.cview(), order_.cview(), positions_.view());
  }

  [[nodiscard]] int depth() const override { return data_.depth; }
  [[nodiscard]] std::int64_t points() const override { return positions_.size(); }
  [[nodiscard]] Vec3d cube_lower() const override { return frame_.lower; }
  [[nodiscard]] double cube_size() const override { return frame_.size; }
  [[nodiscard]] std::vector<std::int32_t> point_order() const override {
    ex_->activate();
    return engine::to_vector(*ex_, order_);
  }

  [[nodiscard]] OctreeLevel level(int depth) const override {
    ex_->activate();
    const LevelData& data = data_.levels[static_cast<std::size_t>(depth)];
    OctreeLevel level;
    level.depth = depth;
    level.cells = data_.view().levels[depth].cells();
    level.nodes = std::int64_t{8} * data.bricks;
    level.brick_keys = engine::to_vector(*ex_, data.brick_key);
    level.parents = engine::to_vector(*ex_, data.parent);
    level.neighbours = engine::to_vector(*ex_, data.neighbours);
    level.child_bricks = engine::to_vector(*ex_, data.child_brick);
    level.child_bricks.resize(static_cast<std::size_t>(level.nodes), -1);  // the finest level has none
    level.point_begin = engine::to_vector(*ex_, data.point_begin);
    level.point_begin.resize(static_cast<std::size_t>(level.cells) + 1);
    return level;
  }

  [[nodiscard]] std::vector<OctreeLeaf> locate(const std::vector<Vec3f>& queries) const override {
    ex_->activate();
    const exec::Buffer<Vec3f> unit = to_unit(upload(queries));
    auto leaves = exec::make_buffer<OctreeLeaf>(*ex_, unit.size());
    for_each(*ex_, "octree.locate", unit.size(), engine::Locate{data_.view(), unit.cview(), leaves.view()});
    return engine::to_vector(*ex_, leaves);
  }

  [[nodiscard]] OctreeNeighbours nearest(const std::vector<Vec3f>& queries, int k) const override {
    ex_->activate();
    const exec::Buffer<Vec3f> unit = to_unit(upload(queries));
    const auto found = static_cast<int>(std::min<std::int64_t>(k, points()));
    auto ids = exec::make_buffer<std::int32_t>(*ex_, unit.size() * found);
    auto squared = exec::make_buffer<float>(*ex_, unit.size() * found);
    find_nearest(*ex_, search_view(), unit.cview(), found, ids.view(), squared.view());
    OctreeNeighbours result;
    for (std::size_t q = 0; q <= queries.size(); ++q) result.begin.push_back(static_cast<std::int64_t>(q) * found);
    result.points = engine::to_vector(*ex_, ids);
    result.distances = distances_world(squared);
    return result;
  }

  [[nodiscard]] OctreeNeighbours within(const std::vector<Vec3f>& queries, double radius) const override {
    ex_->activate();
    const exec::Buffer<Vec3f> unit = to_unit(upload(queries));
    const WithinRadius found = find_within(*ex_, search_view(), unit.cview(), static_cast<float>(radius / frame_.size));
    const std::vector<std::int32_t> begin = engine::to_vector(*ex_, found.begin);
    return {{begin.begin(), begin.end()}, engine::to_vector(*ex_, found.ids), distances_world(found.squared)};
  }

 private:
  [[nodiscard]] SearchView search_view() const { return {data_.view(), positions_.cview(), order_.cview()}; }

  [[nodiscard]] exec::Buffer<Vec3f> upload(const std::vector<Vec3f>& points) const {
    auto buffer = exec::make_buffer<Vec3f>(*ex_, static_cast<std::int64_t>(points.size()));
    copy_to_device(*ex_, points.data(), buffer.view());
    return buffer;
  }
  [[nodiscard]] exec::Buffer<Vec3f> to_unit(const exec::Buffer<Vec3f>& world) const {
    auto unit = exec::make_buffer<Vec3f>(*ex_, world.size());
    for_each(*ex_, "octree.unit", world.size(), ToUnit{frame_, world.cview(), unit.view()});
    return unit;
  }
  [[nodiscard]] std::vector<float> distances_world(const exec::Buffer<float>& squared) const {
    std::vector<float> distances = engine::to_vector(*ex_, squared);
    for (float& d : distances) d = static_cast<float>(std::sqrt(static_cast<double>(d)) * frame_.size);
    return distances;
  }

  std::unique_ptr<Exec> ex_;  // searches enqueue work, so const members use it too
  Frame frame_;
  OctreeData data_;
  exec::Buffer<std::int32_t> order_;
  exec::Buffer<Vec3f> positions_;
};

}  // namespace pointskin::octree
