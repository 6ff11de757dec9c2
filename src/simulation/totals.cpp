#include "simulation/step.hpp"

#include "exec/this_space.hpp"

namespace pointskin::simulation {
namespace {

struct AddTotals {
  PSK_HD static float least(float a, float b) { return b < a ? b : a; }
  PSK_HD static float most(float a, float b) { return b > a ? b : a; }
  PSK_HD static Bounds join(const Bounds& a, const Bounds& b) {
    return {{least(a.lower.x, b.lower.x), least(a.lower.y, b.lower.y), least(a.lower.z, b.lower.z)},
            {most(a.upper.x, b.upper.x), most(a.upper.y, b.upper.y), most(a.upper.z, b.upper.z)}};
  }
  PSK_HD Totals operator()(const Totals& a, const Totals& b) const {
    return {a.compression + b.compression,
            a.squared_speed + b.squared_speed,
            a.height + b.height,
            join(a.box, b.box),
            most(a.most_compression, b.most_compression),
            most(a.fastest_squared, b.fastest_squared),
            a.crowded + b.crowded,
            a.lost + b.lost};
  }
};

struct TotalsOfParticle {
  ArrayView<const Vec3f> position, velocity;
  ArrayView<const float> density;
  ArrayView<const std::uint8_t> neighbours;
  Vec3f tank;
  int lanes;

  PSK_HD Totals operator()(std::int64_t i) const {
    const Vec3f p = position[i];
    const Vec3f v = velocity[i];
    const float squared = dot(v, v);
    const float compression = density[i] > 1 ? density[i] - 1 : 0.0F;
    const bool inside = p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x <= tank.x && p.y <= tank.y && p.z <= tank.z;
    const bool finite = squared < 1e30F;  // false for NaN
    return {compression, squared, p.y, {p, p}, compression, squared, is_crowded(i) ? 1 : 0, inside && finite ? 0 : 1};
  }
  [[nodiscard]] PSK_HD bool is_crowded(std::int64_t i) const {
    bool any = false;
    for (int lane = 0; lane < lanes; ++lane) any = any || neighbours[i * lanes + lane] > most_neighbours(lanes);
    return any;
  }
};

struct ToWorld {
  float radius;
  ArrayView<const Vec3f> position, velocity;
  WorldViews out;
  PSK_HD void operator()(std::int64_t i) const {
    out.positions[i] = radius * position[i];
    if (out.velocities[0].empty()) return;
    const Vec3f v = radius * velocity[i];
    out.velocities[0][i] = v.x;
    out.velocities[1][i] = v.y;
    out.velocities[2][i] = v.z;
  }
};

}  // namespace

template <exec::Space Exec>
Totals totals_of(Exec& ex, const Particles& particles, const Solids& solids) {
  return exec::reduce<Totals>(
      ex, "simulation.totals", particles.position.size(),
      TotalsOfParticle{particles.position.cview(), particles.velocity.cview(), particles.density.cview(),
                       particles.neighbours.cview(), solids.tank, lanes_for(particles.position.size())},
      AddTotals{});
}

template <exec::Space Exec>
void to_world(Exec& ex, const Particles& particles, float radius_world, const WorldViews& out) {
  for_each(ex, "simulation.world", particles.position.size(),
           ToWorld{radius_world, particles.position.cview(), particles.velocity.cview(), out});
}

PSK_INSTANTIATE(totals_of);
PSK_INSTANTIATE(to_world);

}  // namespace pointskin::simulation
