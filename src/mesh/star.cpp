#include "mesh/star.hpp"

#include <numeric>

namespace pointskin::mesh_detail {
namespace {

std::int32_t fan_of(std::vector<std::int32_t>& fans, std::int32_t member) {
  while (fans[static_cast<std::size_t>(member)] != member) {
    std::int32_t& above = fans[static_cast<std::size_t>(member)];
    above = fans[static_cast<std::size_t>(above)];
    member = above;
  }
  return member;
}

/// Counts one edge from the spokes [begin, end) that lie on it.
void count_edge(const Spoke* begin, const Spoke* end, MeshReport& report) {
  ++report.edges;
  const std::ptrdiff_t sides = end - begin;
  if (sides == 1) ++report.boundary_edges;
  if (sides == 2 && begin[0].outgoing == begin[1].outgoing) ++report.misoriented_edges;
  if (sides > 2) ++report.non_manifold_edges;
}

}  // namespace

void count_star(std::int32_t v, Star& star, MeshReport& report) {
  std::sort(star.spokes.begin(), star.spokes.end(), [](const Spoke& a, const Spoke& b) { return a.to < b.to; });
  std::int32_t fan_count = star.members;
  star.fans.resize(static_cast<std::size_t>(fan_count));
  std::iota(star.fans.begin(), star.fans.end(), 0);
  const Spoke* const last = star.spokes.data() + star.spokes.size();
  for (const Spoke* begin = star.spokes.data(); begin != last;) {
    const Spoke* end = begin + 1;
    for (; end != last && end->to == begin->to; ++end) {
      const std::int32_t a = fan_of(star.fans, begin->member);
      const std::int32_t b = fan_of(star.fans, end->member);
      if (a == b) continue;
      star.fans[static_cast<std::size_t>(b)] = a;
      --fan_count;
    }
    if (begin->to > v) count_edge(begin, end, report);
    begin = end;
  }
  if (fan_count > 1) ++report.non_manifold_vertices;
}

void add(const MeshReport& part, MeshReport& sum) {
  sum.used_vertices += part.used_vertices;
  sum.edges += part.edges;
  sum.boundary_edges += part.boundary_edges;
  sum.non_manifold_edges += part.non_manifold_edges;
  sum.misoriented_edges += part.misoriented_edges;
  sum.non_manifold_vertices += part.non_manifold_vertices;
  sum.degenerate_triangles += part.degenerate_triangles;
  sum.components += part.components;
  sum.volume += part.volume;
  sum.area += part.area;
}

}  // namespace pointskin::mesh_detail
