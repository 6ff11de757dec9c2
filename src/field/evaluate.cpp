#include "field/evaluate.hpp"

#include "exec/this_space.hpp"

namespace pointskin::field {
namespace {

struct Evaluate {
  FieldView f;
  ArrayView<const Vec3f> points;
  ArrayView<float> values;
  PSK_HD void operator()(std::int64_t i) const {
    values[i] = octree::value_at(f.tree, f.values, points[i], f.tree.depth);
  }
};

}  // namespace

template <exec::Space Exec>
void evaluate(Exec& ex, const FieldView& f, ArrayView<const Vec3f> points, ArrayView<float> values) {
  for_each(ex, "field.evaluate", points.size, Evaluate{f, points, values});
}

PSK_INSTANTIATE(evaluate);

}  // namespace pointskin::field
