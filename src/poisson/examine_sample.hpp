// What examine_samples() does with one sample.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "exec/atomic.hpp"
#include "poisson/bend.hpp"
#include "poisson/noise.hpp"
#include "poisson/outliers.hpp"

namespace pointskin::poisson {

/// What a look at the whole cloud says.
struct Cloudwide {
  Averaging averaging{};
  float largest_usual_area = 0;  ///< finest cells^2
  bool is_alike = false;         ///< neighbours mostly face the same way, as far as can be told
};

struct Examine {
  Around around;
  ArrayView<const Cloudwide> found;
  float cell_area, coarsest, finest;
  ArrayView<float> areas;
  ArrayView<float> bends_to_urges;
  ArrayView<float> own_side_to_depths;  // read, then written: others still look at the depths that were
  std::uint64_t* lonely;

  /// What a sample is judged by.
  struct Evidence {
    Seen seen;
    BendAmongNeighbours bend;
    float own = 0;  ///< area on the own side
    bool disagrees = false, is_usual = true;
  };

  PSK_HD void operator()(std::int64_t i) const {
    const Cloudwide cloud = found[0];
    const Evidence evidence = look_around(i, around, cloud);
    count_if_lonely(evidence, cloud);
    const bool is_confirmed = evidence.is_usual || Around::is_confirmed(around, i);
    const bool is_among_such = !asks_for_such(i, evidence, cloud) || Around::is_among_such(around, i);
    finish(i, evidence, cloud, is_confirmed, is_among_such);
  }

  /// @param near  the positions and normals of `around` at kWindow places before and after i; others may be missing
  [[nodiscard]] PSK_HD Evidence look_around(std::int64_t i, const Around& near, const Cloudwide& cloud) const {
    Evidence evidence;
    evidence.disagrees = own_side_to_depths[i] < 0;
    evidence.own = std::abs(own_side_to_depths[i]);
    evidence.is_usual = !(evidence.own > cloud.largest_usual_area);
    const float per_sample = 1 / (evidence.own * cell_area);
    const Vec3f own_normal = near.normals[i];
    near(i, [&](std::int64_t /*j*/, const Vec3f& normal, const Vec3f& step) {
      const float cosine = dot(own_normal, normal);
      evidence.seen.add(cosine, normal, step);
      evidence.bend.add(cosine, squared_length(step) * per_sample);
    });
    return evidence;
  }

  PSK_HD void count_if_lonely(const Evidence& evidence, const Cloudwide& cloud) const {
    if (evidence.own > kLonely * cloud.largest_usual_area) exec::add(lonely, 1);
  }

  /// Whether it depends on Around::is_among_such if a sample is an outlier.
  [[nodiscard]] PSK_HD bool asks_for_such(std::int64_t i, const Evidence& evidence, const Cloudwide& cloud) const {
    const Seen& seen = evidence.seen;
    return cloud.is_alike && seen.can_tell() && seen.faces_like_others() && !seen.surely_does() &&
           !seen.stands_off(areas[i] * cell_area);
  }

  /// @param is_confirmed   of a sample with an unusual area
  /// @param is_among_such  of one that asks for it
  PSK_HD void finish(std::int64_t i, const Evidence& evidence, const Cloudwide& cloud, bool is_confirmed,
                     bool is_among_such) const {
    const float largest = cloud.largest_usual_area;
    float area = evidence.own;
    if ((!evidence.is_usual && !is_confirmed) || is_outlier_near_others(i, evidence, cloud, is_among_such)) {
      area = 0;
    } else if (!evidence.is_usual) {
      area = areas[i] < largest ? largest : areas[i];
    }
    areas[i] = area;
    float depth = around.splat_depths[i];
    float urge = 1;
    if (area > 0) {
      const float near = evidence.bend.value();
      const float samples = cloud.averaging.samples(near > bends_to_urges[i] ? near : bends_to_urges[i]);
      depth += Averaging::levels_finer(samples);
      urge = Averaging::urge(samples, depth - finest);
    }
    bends_to_urges[i] = urge;
    own_side_to_depths[i] = depth > coarsest ? depth : coarsest;
  }

 private:
  [[nodiscard]] PSK_HD bool is_outlier_near_others(std::int64_t i, const Evidence& evidence, const Cloudwide& cloud,
                                                   bool is_among_such) const {
    const Seen& seen = evidence.seen;
    if (seen.stands_off(areas[i] * cell_area)) return true;
    if (!cloud.is_alike) return false;
    const bool faces_like_others = seen.faces_like_others() && (seen.surely_does() || is_among_such);
    return (seen.can_tell() && !faces_like_others) || (evidence.disagrees && seen.none_faces_it());
  }
};

}  // namespace pointskin::poisson
