#include "scale/block_looks.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "diagnose/look_at.hpp"
#include "diagnose/spread.hpp"
#include "exec/memory.hpp"
#include "octree/keys.hpp"
#include "poisson/in_blocks.hpp"

namespace pointskin::scale {
namespace {

using diagnose::Spread;

/// One value for each of some samples, by their places in the whole cloud.
template <class T>
struct Column {
  const std::vector<std::int64_t>* places = nullptr;  // ascending
  const T* values = nullptr;
  std::int64_t size = 0;  // of the whole cloud

  const T& operator[](std::int64_t i) const {
    return values[std::lower_bound(places->begin(), places->end(), i) - places->begin()];
  }
  [[nodiscard]] bool empty() const { return size == 0; }
};

/// As diagnose::LookAtPairs reads samples.
struct Columns {
  Column<Vec3f> positions, normals;
  Column<float> areas;
};

/// Some samples of a cloud in memory.
class Gathered {
 public:
  /// @param places  of the samples, in any order; they may repeat
  Gathered(exec::Cpu& ex, const SortedCloud& cloud, const SampleValues& values, std::vector<std::int64_t> places)
      : all_(cloud.size()), places_(std::move(places)) {
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    const auto n = std::ssize(places_);
    positions_ = exec::make_buffer<Vec3f>(ex, n);
    normals_ = exec::make_buffer<Vec3f>(ex, n);
    areas_ = exec::make_buffer<float>(ex, n);
    for (std::int64_t at = 0, end = 0; at < n; at = end) {  // runs of samples that follow each other
      while (end < n && place(end) - place(at) == end - at) ++end;
      cloud.read(place(at), end - at, {positions_.data() + at, normals_.data() + at});
      values.read(SampleValues::area, place(at), areas_.view().part(at, end - at));
    }
    poisson::normalise_normals(ex, normals_.view());
  }

  [[nodiscard]] Columns columns() const {
    return {{&places_, positions_.data(), all_}, {&places_, normals_.data(), all_}, {&places_, areas_.data(), all_}};
  }

 private:
  [[nodiscard]] std::int64_t place(std::int64_t i) const { return places_[static_cast<std::size_t>(i)]; }

  std::int64_t all_;
  std::vector<std::int64_t> places_;
  exec::Buffer<Vec3f> positions_, normals_;
  exec::Buffer<float> areas_;
};

octree::Coordinates beside(octree::Coordinates c, int axis, int side) {
  (axis == 0 ? c.x : axis == 1 ? c.y : c.z) += side;
  return c;
}

/// The first samples of the cells beside that of a sample, of the finest level whose cell there holds a few.
void add_across(const KeyIndex& index, std::uint64_t point_key, int depth, int axis, std::vector<std::int64_t>& found) {
  const auto cell = [&] { return octree::decode(octree::cell_key(point_key, depth)); };
  const auto held = [&] {
    const SampleRun samples = index.samples_in(cell(), depth);
    return samples.end - samples.begin;
  };
  while (depth > 0 && held() < diagnose::kFewSamples) --depth;
  for (const int side : {-1, 1}) {
    const SampleRun samples = index.samples_in(beside(cell(), axis, side), depth);
    if (samples.begin < samples.end) found.push_back(samples.begin);
  }
}

/// True if no cell of a level at a point, nor around it, holds a sample.
bool is_far(const KeyIndex& index, const Vec3f& p, int depth) {
  const octree::Coordinates at = octree::decode(octree::cell_key(octree::point_key(p.x, p.y, p.z), depth));
  const auto is_occupied = [&](int dx, int dy, int dz) {
    const SampleRun samples = index.samples_in({at.x + dx, at.y + dy, at.z + dz}, depth);
    return samples.begin < samples.end;
  };
  if (is_occupied(0, 0, 0)) return false;  // of most
  for (int dx = -1; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dz = -1; dz <= 1; ++dz)
        if (is_occupied(dx, dy, dz)) return false;
  return true;
}

}  // namespace

void look_at_pairs(exec::Cpu& ex, const SortedCloud& cloud, const SampleValues& values, const KeyIndex& index,
                   int depth, diagnose::Counts& counts) {
  const std::int64_t n = cloud.size();
  const Spread spread{std::min(n, diagnose::kSamples), n};
  using Pairs = diagnose::LookAtPairs<Columns>;
  std::vector<std::int64_t> places;
  std::vector<std::pair<std::int64_t, std::int64_t>> across;  // sample, and one in a cell beside it
  for (std::int64_t s = 0; s < spread.some; ++s) {
    const std::int64_t i = spread(s);
    for (int step = 0; step <= diagnose::kFollowers; ++step) places.push_back(i + step);
    for (int k = 0; k < diagnose::kScatterSteps; ++k) places.push_back(i + Pairs::scatter_step(k));
    if (!diagnose::looks_across(s)) continue;
    std::uint64_t key = 0;
    cloud.read(i, 1, {.keys = &key});
    std::vector<std::int64_t> found;
    add_across(index, key, depth, diagnose::axis_across(s), found);
    for (const std::int64_t other : found) {
      across.emplace_back(i, other);
      places.push_back(other);
    }
  }
  std::erase_if(places, [&](std::int64_t place) { return place >= n; });
  const Gathered gathered(ex, cloud, values, std::move(places));
  const Columns samples = gathered.columns();
  const Pairs pairs{samples, depth};
  diagnose::Tally<diagnose::kAlike, diagnose::kFacesInside> tally;
  for (std::int64_t s = 0; s < spread.some; ++s) pairs.look_at(spread(s), tally);
  for (const auto& [i, other] : across) pairs.compare(i, other, tally);
  tally.flush(&counts);
}

void look_at_triangles(const BlockMeshes& meshes, const KeyIndex& index, int far_depth, diagnose::Counts& counts) {
  const Spread spread{std::min(meshes.triangles(), diagnose::kTriangles), meshes.triangles()};
  diagnose::Tally<diagnose::kSurface, diagnose::kSums> tally;
  for (std::int64_t s = 0; s < spread.some; ++s) {
    BlockMeshes::Indices vertices{};
    meshes.read_triangles(spread(s), 1, &vertices);
    std::array<Vec3f, 3> corners{};
    for (std::size_t v = 0; v < 3; ++v)
      meshes.read_column(0, vertices[v], 1, reinterpret_cast<std::byte*>(&corners[v]));
    diagnose::look_at_triangle(
        corners[0], corners[1], corners[2], [&](const Vec3f& p) { return is_far(index, p, far_depth); }, tally);
  }
  tally.flush(&counts);
}

}  // namespace pointskin::scale
