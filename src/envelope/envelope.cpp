#include "envelope/envelope.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"
#include "mesh/mesh_checks.hpp"

namespace pointskin::envelope {
namespace {

using mesh_detail::SignedDistance;
using mesh_detail::SurfacePlace;

constexpr std::int64_t kBlock = 256;

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::invalid_input, "the envelope " + why + "; it must be a closed mesh that faces outwards");
}

void check(exec::Cpu& ex, const Mesh& mesh) {
  if (mesh.triangles.empty()) refuse("has no triangles");
  const MeshReport report = measure(mesh, ex.threads());
  if (!mesh_detail::corner_bounds(ex, mesh).finite) refuse("has vertices that are not finite");
  if (report.boundary_edges > 0) refuse("is not closed: " + std::to_string(report.boundary_edges) + " boundary edges");
  if (!report.manifold())
    refuse("is not manifold: " + std::to_string(report.non_manifold_edges) + " edges, " +
           std::to_string(report.non_manifold_vertices) + " vertices, " + std::to_string(report.degenerate_triangles) +
           " degenerate triangles");
  if (!report.oriented()) refuse("has neighbouring triangles that face different ways");
  if (!(report.volume > 0)) refuse("encloses no volume or is turned inside out");
}

Vec3d to_world(const octree::Frame& frame, const Vec3f& unit) { return frame.lower + frame.size * to_double(unit); }

Vec3f to_unit(const octree::Frame& frame, const Vec3d& world) {
  const Vec3d unit = 1 / frame.size * (world - frame.lower);
  return {static_cast<float>(unit[0]), static_cast<float>(unit[1]), static_cast<float>(unit[2])};
}

/// Tells for one point after another whether it lies deeper inside than a limit. Within the distance of the last point
/// from where a limit is reached nothing changes, and nothing is measured.
class Walk {
 public:
  explicit Walk(const SignedDistance& distance) : distance_(distance) {}

  /// True if the signed distance of `p` is above `limit`.
  bool is_inside(const Vec3d& p, double limit) {
    if (place_.slot >= 0) {
      const double reach = (1 + 1e-9) * length(p - at_);
      if (place_.distance - reach > limit) return true;
      if (place_.distance + reach < limit) return false;
    }
    return measured(p).distance > limit;
  }

  const SurfacePlace& measured(const Vec3d& p) {
    place_ = distance_.at(p, place_.slot);
    at_ = p;
    return place_;
  }

 private:
  const SignedDistance& distance_;
  Vec3d at_{};
  SurfacePlace place_;
};

/// Runs part(begin, end) -> Part over blocks of [0, n) and returns the parts in their order.
template <class Part, class Run>
std::vector<Part> run_parts(exec::Cpu& ex, std::int64_t n, const Run& run) {
  std::vector<Part> parts(static_cast<std::size_t>(exec::block_count(n, kBlock)));
  ex.run_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t b) {
    parts[static_cast<std::size_t>(b)] = run(b * kBlock, std::min(n, (b + 1) * kBlock));
  });
  return parts;
}

/// Moves the vertices outside to where move_to(i, position, walk) wants them, if anywhere.
template <class MoveTo>
Moved move_outside(exec::Cpu& ex, const SignedDistance& distance, const octree::Frame& frame, ArrayView<Vec3f> vertices,
                   const MoveTo& move_to) {
  const auto parts = run_parts<Moved>(ex, vertices.size, [&](std::int64_t begin, std::int64_t end) {
    Walk walk(distance);
    Moved moved;
    for (std::int64_t i = begin; i < end; ++i) {
      const Vec3d p = to_world(frame, vertices[i]);
      if (walk.is_inside(p, -kTolerance * frame.size)) continue;
      const std::optional<Vec3d> to = move_to(i, p, walk);
      if (!to) continue;
      vertices[i] = to_unit(frame, *to);
      ++moved.vertices;
      moved.farthest = std::max(moved.farthest, length(*to - p));
    }
    return moved;
  });
  Moved all;
  for (const Moved& part : parts) {
    all.vertices += part.vertices;
    all.farthest = std::max(all.farthest, part.farthest);
  }
  return all;
}

/// The last point inside on the way from `inside` to `outside`, to within `accuracy`: regula falsi and halving in turn.
Vec3d crossing(const SignedDistance& distance, const Vec3d& inside, const SurfacePlace& at_inside, const Vec3d& outside,
               const SurfacePlace& at_outside, double accuracy) {
  constexpr int kMostSteps = 64;
  const Vec3d way = outside - inside;
  double low = 0, high = 1;
  double depth = at_inside.distance, height = at_outside.distance;  // at these, > 0 and < 0
  std::int32_t hint = at_inside.slot;
  for (int step = 0; step < kMostSteps && depth > accuracy && (high - low) * length(way) > accuracy; ++step) {
    const double t = step % 2 == 0 ? low + (high - low) * (depth / (depth - height)) : (low + high) / 2;
    const SurfacePlace here = distance.at(inside + t * way, hint);
    hint = here.slot;
    (here.distance >= 0 ? low : high) = t;
    (here.distance >= 0 ? depth : height) = here.distance;
  }
  return inside + low * way;
}

}  // namespace

Envelope::Envelope(std::shared_ptr<const Mesh> mesh, const Vec3d& origin, int threads)
    : mesh_(std::move(mesh)), ex_(std::make_unique<exec::Cpu>(threads)) {
  check(*ex_, *mesh_);
  distance_ = std::make_unique<SignedDistance>(*ex_, *mesh_, mesh_->origin - origin);
}

Envelope::~Envelope() = default;

std::int64_t Envelope::drop_outside(const octree::Frame& frame, ArrayView<const Vec3f> positions,
                                    ArrayView<float> areas) const {
  const double limit = -kTolerance * frame.size;
  const auto counts = run_parts<std::int64_t>(*ex_, positions.size, [&](std::int64_t begin, std::int64_t end) {
    Walk walk(*distance_);
    std::int64_t outside = 0;
    for (std::int64_t i = begin; i < end; ++i) {
      if (walk.is_inside(to_world(frame, positions[i]), limit)) continue;
      areas[i] = 0;
      ++outside;
    }
    return outside;
  });
  std::int64_t sum = 0;
  for (const std::int64_t count : counts) sum += count;
  return sum;
}

void Envelope::hold_outside(const octree::Frame& frame, const octree::LevelView& level, std::uint8_t* free) const {
  const double cell = frame.size / static_cast<double>(std::int64_t{1} << level.depth);
  ex_->run_blocks(exec::block_count(level.bricks, kBlock), [&](std::int64_t block) {
    Walk walk(*distance_);
    for (std::int64_t b = block * kBlock; b < std::min<std::int64_t>(level.bricks, (block + 1) * kBlock); ++b) {
      if (free[b] == 0) continue;
      const octree::Coordinates c = octree::decode(level.brick_key[b]);
      for (int s = 0; s < 8; ++s) {
        if ((free[b] >> s & 1) == 0) continue;
        const Vec3d corner{static_cast<double>(2 * c.x + octree::slot_x(s)),
                           static_cast<double>(2 * c.y + octree::slot_y(s)),
                           static_cast<double>(2 * c.z + octree::slot_z(s))};
        if (!walk.is_inside(frame.lower + cell * corner, kCornerMargin * cell))
          free[b] = static_cast<std::uint8_t>(free[b] & ~(1U << s));
      }
    }
  });
}

Moved Envelope::clip(const octree::Frame& frame, ArrayView<Vec3f> vertices, ArrayView<const Vec3f> inside_ends) const {
  const auto along_edge = [&](std::int64_t i, const Vec3d& p, Walk&) -> std::optional<Vec3d> {
    const SurfacePlace outside = distance_->at(p);
    const Vec3d end = to_world(frame, inside_ends[i]);
    const SurfacePlace inside = distance_->at(end, outside.slot);
    if (!(inside.distance > 0)) return std::nullopt;
    return crossing(*distance_, end, inside, p, outside, kTolerance * frame.size / 4);
  };
  return move_outside(*ex_, *distance_, frame, vertices, along_edge);
}

Moved Envelope::project(const octree::Frame& frame, ArrayView<Vec3f> vertices) const {
  const auto to_nearest = [](std::int64_t, const Vec3d& p, Walk& walk) -> std::optional<Vec3d> {
    return walk.measured(p).position;
  };
  return move_outside(*ex_, *distance_, frame, vertices, to_nearest);
}

}  // namespace pointskin::envelope
