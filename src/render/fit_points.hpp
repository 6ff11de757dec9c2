// What a camera is fitted to.
#pragma once

#include <pointskin/render.hpp>

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "core/box.hpp"
#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::render_detail {

/// Some of the vertices of a mesh, or of the points of a cloud; or the corners of a box. The positions must outlive it.
class FitPoints {
 public:
  /// The finite vertices that a triangle of `mesh` names, ids in range; the corners of `box` if there is one. O(v + t).
  FitPoints(const Mesh& mesh, const std::optional<WorldBox>& box);
  /// The finite points of `cloud` that are no strays; the corners of `box` if there is one. O(n).
  FitPoints(const Cloud& cloud, const std::optional<WorldBox>& box, int threads);

  /// Combines the values of all points: starts from `first` and calls add(value, point), then join(value, value).
  /// What they do must not depend on the order: a largest or smallest value.
  template <class T, class Add, class Join>
  T reduce(exec::Cpu& ex, const T& first, const Add& add, const Join& join) const {
    const ArrayView<const Vec3f> positions = view();
    std::vector<T> part(static_cast<std::size_t>(exec::block_count(positions.size, kBlock)), first);
    ex.run_blocks(static_cast<std::int64_t>(part.size()), [&](std::int64_t b) {
      T value = first;  // on the stack: parts of neighbours share cache lines
      for (std::int64_t i = b * kBlock; i < std::min(positions.size, (b + 1) * kBlock); ++i)
        if (counts(i)) add(value, to_double(positions[i]));
      part[static_cast<std::size_t>(b)] = value;
    });
    T all = first;
    for (const T& value : part) join(all, value);
    return all;
  }

  /// Around all points, relative to the origin; as it begins if there are none.
  [[nodiscard]] Box box(exec::Cpu& ex) const;
  /// The middle of the box; zero if there are no points.
  [[nodiscard]] Vec3d centre(exec::Cpu& ex) const;
  /// Largest distance of a point from `place`; 0 if there are none.
  [[nodiscard]] double radius_about(exec::Cpu& ex, const Vec3d& place) const;
  /// Points left out because they are strays.
  [[nodiscard]] std::int64_t strays() const { return strays_; }

 private:
  static constexpr std::int64_t kBlock = 1 << 14;

  [[nodiscard]] ArrayView<const Vec3f> view() const;
  [[nodiscard]] bool counts(std::int64_t i) const { return used_.empty() || used_[static_cast<std::size_t>(i)] != 0; }
  void use_box(const WorldBox& box, const Vec3d& origin);

  ArrayView<const Vec3f> positions_;
  std::vector<Vec3f> corners_;      // of the box; empty: positions_
  std::vector<std::uint8_t> used_;  // shape of positions_; empty: all
  std::int64_t strays_ = 0;
};

}  // namespace pointskin::render_detail
