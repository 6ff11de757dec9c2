#pragma once

#include "exec/algorithms.hpp"
#include "field/evaluate.hpp"

namespace pointskin::field {
namespace detail {

struct Evaluate {
  FieldView f;
  ArrayView<const Vec3f> points;
  ArrayView<float> values;
  PSK_HD void operator()(std::int64_t i) const {
    values[i] = octree::value_at(f.tree, f.values, points[i], f.tree.depth);
  }
};

}  // namespace detail

template <exec::Space Exec>
void evaluate(Exec& ex, const FieldView& f, ArrayView<const Vec3f> points, ArrayView<float> values) {
  for_each(ex, "field.evaluate", points.size, detail::Evaluate{f, points, values});
}

}  // namespace pointskin::field
