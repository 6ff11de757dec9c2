#include "mesh_teller.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "ms_since.hpp"
#include "studio/wire/colours.hpp"

namespace pointskin::studio {
namespace {

constexpr std::int64_t kFirstPoints = 200'000, kPartPoints = 1'000'000;
constexpr std::size_t kMeshesKept = 6, kFramesKept = 6, kGhostsKept = 4;

template <class T>
std::vector<T> chosen(const std::vector<T>& from, const std::int64_t* first, const std::int64_t* last) {
  std::vector<T> out;
  if (from.empty()) return out;
  out.reserve(static_cast<std::size_t>(last - first));
  for (; first != last; ++first) out.push_back(from[static_cast<std::size_t>(*first)]);
  return out;
}

wire::PointSet all_points(const Cloud& cloud) { return {cloud.origin, cloud.positions, cloud.normals, {}, {}}; }

std::vector<std::byte> encoded(const wire::PointSet& points) {
  const Bounds box = points.positions.empty() ? Bounds{{}, {}} : bounds_of(points.positions);
  return encode_points(points, box, false);
}

}  // namespace

std::uint64_t MeshTeller::announce(Json event, bool may_drop) {
  const int told = services_.audience.show(event, may_drop);
  if (!may_drop) services_.audience.remember("mesh", {std::move(event)});
  return told > 0 || !may_drop ? version_ : 0;
}

std::uint64_t MeshTeller::show(const Mesh& mesh, const MeshFacts& facts) {
  if (facts.preview && !services_.audience.somebody_waits()) return 0;
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::byte> data =
      wire::encode_mesh(mesh, {.values = facts.values, .tint = facts.tint, .threads = services_.device.threads});
  const std::size_t bytes = data.size();
  const std::uint64_t blob = services_.blobs.add(facts.preview ? "preview" : "mesh", std::move(data), kMeshesKept);
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  Json event = {{"event", "mesh"},
                {"scene", scene_},
                {"version", ++version_},
                {"blob", blob},
                {"bytes", bytes},
                {"preview", facts.preview},
                {"depth", facts.depth},
                {"triangles", triangles},
                {"vertices", mesh.vertices.size()},
                {"full_triangles", facts.full_triangles > 0 ? facts.full_triangles : triangles}};
  Json values = Json::array();
  for (const wire::Values& each : facts.values) values.push_back(each.name);
  event["values"] = std::move(values);
  event["ms"] = facts.ms;
  event["ms"]["encode"] = ms_since(start);
  return announce(std::move(event), facts.preview);
}

bool MeshTeller::show_frame(const Mesh& mesh, Json facts) {
  if (!services_.audience.somebody_waits()) return false;
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t blob =
      services_.blobs.add("frame", wire::encode_mesh(mesh, {.threads = services_.device.threads}), kFramesKept);
  Json event = {{"event", "frame"}, {"scene", scene_}, {"version", ++version_}, {"blob", blob}};
  event["triangles"] = mesh.triangles.size();
  event.update(facts);
  event["ms"]["encode"] = ms_since(start);
  return services_.audience.show(event, true) > 0;
}

void MeshTeller::show_points(const Cloud& cloud, std::int64_t most_points) {
  services_.blobs.forget("points");
  services_.audience.remember("points", {});
  const std::vector<std::int64_t> order = wire::even_order(cloud.positions);
  const std::int64_t total = cloud.size();
  const std::int64_t shown = std::min(total, most_points);
  const Bounds box = cloud.positions.empty() ? Bounds{{}, {}} : bounds_of(cloud.positions);
  const std::vector<std::uint8_t> colours = wire::colours_of(cloud.attributes, static_cast<std::size_t>(total));
  std::int64_t from = 0;
  do {
    const std::int64_t count = std::min(shown - from, from == 0 ? kFirstPoints : kPartPoints);
    const std::int64_t* first = order.data() + from;
    wire::PointSet part{cloud.origin,
                        chosen(cloud.positions, first, first + count),
                        chosen(cloud.normals, first, first + count),
                        {},
                        {}};
    for (std::int64_t i = 0; i < count && !colours.empty(); ++i) {
      const std::uint8_t* colour = colours.data() + 4 * first[i];
      part.colours.insert(part.colours.end(), colour, colour + 4);
    }
    const std::uint64_t blob = services_.blobs.add("points", encode_points(part, box, false), SIZE_MAX);
    const Json event = {{"event", "points"},
                        {"scene", scene_},
                        {"blob", blob},
                        {"from", from},
                        {"count", count},
                        {"total", total},
                        {"final", from + count == shown}};
    services_.audience.remember_more("points", event);
    services_.audience.tell(event);
    from += count;
  } while (from < shown && !services_.queue.waiting("open"));
}

void MeshTeller::show_ghosts(const Cloud& added, const Cloud& removed) {
  const auto blob_of = [this](const Cloud& cloud) {
    return cloud.positions.empty() ? Json(nullptr)
                                   : Json(services_.blobs.add("ghosts", encoded(all_points(cloud)), kGhostsKept));
  };
  services_.audience.tell({{"event", "ghosts"},
                           {"blob", blob_of(added)},
                           {"added", added.size()},
                           {"removed_blob", blob_of(removed)},
                           {"removed", removed.size()}});
}

void MeshTeller::show_tinted(const Cloud& cloud, std::vector<std::uint8_t> tint, Json facts) {
  wire::PointSet points = all_points(cloud);
  points.tint = std::move(tint);
  Json event = {{"event", "ghosts"}, {"blob", services_.blobs.add("ghosts", encoded(points), kGhostsKept)}};
  event.update({{"added", 0}, {"removed_blob", nullptr}, {"removed", 0}, {"tinted", true}});
  event.update(facts);
  services_.audience.tell(event);
}

void MeshTeller::hide_ghosts() { show_ghosts({}, {}); }

}  // namespace pointskin::studio
