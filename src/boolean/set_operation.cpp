#include "boolean/set_operation.hpp"

#include "exec/memory.hpp"
#include "exec/this_space.hpp"

namespace pointskin::boolean {
namespace {

struct FindPlace {
  ArrayView<const field::SurfaceDistance> own, other;
  float coincident;
  ArrayView<Place> places;
  PSK_HD void operator()(std::int64_t i) const { places[i] = place_of(own[i], other[i], coincident); }
};

struct CountFate {
  ArrayView<const Place> places;
  BooleanOp op;
  bool is_first;
  PSK_HD FateCounts operator()(std::int64_t i) const {
    const Fate fate = fate_of(op, is_first, places[i]);
    return {fate != Fate::dropped ? 1 : 0, fate == Fate::flipped ? 1 : 0,
            places[i] == Place::agrees || places[i] == Place::opposes ? 1 : 0};
  }
};
struct AddFates {
  PSK_HD FateCounts operator()(const FateCounts& a, const FateCounts& b) const {
    return {a.kept + b.kept, a.flipped + b.flipped, a.coincident + b.coincident};
  }
};

struct IsKept {
  ArrayView<const Place> places;
  BooleanOp op;
  bool is_first;
  PSK_HD bool operator()(std::int64_t i) const { return fate_of(op, is_first, places[i]) != Fate::dropped; }
};

struct GatherKept {
  OrientedPoints points;
  ArrayView<const std::int32_t> kept;
  IsKept rule;
  ArrayView<Vec3f> positions, normals;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t k = kept[i];
    const std::int32_t from = points.used.empty() ? k : points.used[k];
    const Vec3f n = points.normals[from];
    const bool flip = fate_of(rule.op, rule.is_first, rule.places[k]) == Fate::flipped;
    positions[i] = points.positions[from];
    normals[i] = flip ? Vec3f{-n.x, -n.y, -n.z} : n;
  }
};

}  // namespace

template <exec::Space Exec>
void find_places(Exec& ex, ArrayView<const field::SurfaceDistance> own, ArrayView<const field::SurfaceDistance> other,
                 float coincident, ArrayView<Place> places) {
  for_each(ex, "boolean.places", places.size, FindPlace{own, other, coincident, places});
}

template <exec::Space Exec>
FateCounts count_fates(Exec& ex, ArrayView<const Place> places, BooleanOp op, bool is_first) {
  return exec::reduce<FateCounts>(ex, "boolean.count", places.size, CountFate{places, op, is_first}, AddFates{});
}

template <exec::Space Exec>
void gather_kept(Exec& ex, const OrientedPoints& points, ArrayView<const Place> places, BooleanOp op, bool is_first,
                 ArrayView<Vec3f> positions, ArrayView<Vec3f> normals) {
  const IsKept rule{places, op, is_first};
  const exec::Buffer<std::int32_t> kept = select(ex, "boolean.kept", places.size, rule);
  for_each(ex, "boolean.gather", kept.size(), GatherKept{points, kept.cview(), rule, positions, normals});
}

PSK_INSTANTIATE(find_places);
PSK_INSTANTIATE(count_fates);
PSK_INSTANTIATE(gather_kept);

}  // namespace pointskin::boolean
