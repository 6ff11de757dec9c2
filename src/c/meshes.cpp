#include <pointskin/formats.hpp>
#include <pointskin/merge.hpp>
#include <pointskin/scale.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "c/convert.hpp"
#include "c/defaults.hpp"

using namespace pointskin;
using namespace pointskin::c;

namespace {

/// The arrays of a mesh, wherever they are.
template <class F>
auto look(const psk_mesh* mesh, const F& f) -> decltype(f(std::declval<const Mesh&>(), PSK_HOST)) {
  using Result = decltype(f(std::declval<const Mesh&>(), PSK_HOST));
  if (mesh == nullptr) return Result{};
  if (const auto* host = std::get_if<Mesh>(&mesh->mesh)) return f(*host, PSK_HOST);
  return f(std::get<psk_mesh::OnDevice>(mesh->mesh).mesh, psk_mesh_memory(mesh));
}

template <class T>
std::span<const T> span_of(const std::vector<T>& values) {
  return values;
}
template <class T>
std::span<const T> span_of(const DeviceSpan<T>& values) {
  return {values.data, static_cast<std::size_t>(values.size)};
}

Mesh& host_mesh(psk_mesh* mesh) {
  auto* host = std::get_if<Mesh>(&required(mesh, "mesh").mesh);
  if (host == nullptr) throw Error(ErrorCode::usage, "the mesh is on a device; take psk_mesh_to_host() first");
  return *host;
}

psk_mesh_report report_of(const MeshReport& from) {
  auto to = defaults<psk_mesh_report>();
  to.vertices = from.vertices;
  to.used_vertices = from.used_vertices;
  to.triangles = from.triangles;
  to.edges = from.edges;
  to.boundary_edges = from.boundary_edges;
  to.non_manifold_edges = from.non_manifold_edges;
  to.misoriented_edges = from.misoriented_edges;
  to.non_manifold_vertices = from.non_manifold_vertices;
  to.degenerate_triangles = from.degenerate_triangles;
  to.components = from.components;
  to.euler = from.euler;
  to.volume = from.volume;
  to.area = from.area;
  to.closed = from.closed() ? 1 : 0;
  to.manifold = from.manifold() ? 1 : 0;
  to.oriented = from.oriented() ? 1 : 0;
  to.watertight = from.watertight() ? 1 : 0;
  return to;
}

}  // namespace

psk_code psk_mesh_create(const psk_triangles* triangles, const psk_read_options* options, psk_mesh** mesh,
                         psk_error* error) {
  return guarded(error, [&] {
    const psk_triangles from = known(&required(triangles, "triangles"));
    if (is_on_device(known(&required(from.vertices, "vertices"))) || from.triangles.memory == PSK_DEVICE)
      throw Error(ErrorCode::usage, "a mesh is made of arrays on the host");
    required(mesh, "mesh") =
        new_mesh(mesh_of(strided(from.vertices), strided(from.triangles), read_options_of(options)));
  });
}

psk_code psk_mesh_read(const char* path, const psk_read_options* options, psk_mesh** mesh, psk_error* error) {
  return guarded(
      error, [&] { required(mesh, "mesh") = new_mesh(read_mesh(&required(path, "path"), read_options_of(options))); });
}

psk_code psk_read(const char* path, const psk_read_options* options, psk_cloud** cloud, psk_mesh** mesh,
                  psk_error* error) {
  return guarded(error, [&] {
    required(mesh, "mesh") = nullptr;
    required(cloud, "cloud") = nullptr;
    const std::string name = &required(path, "path");
    if (may_hold_faces(name)) {
      Mesh read = read_mesh(name, read_options_of(options));
      if (!read.triangles.empty()) {
        *mesh = new_mesh(std::move(read));
        return;
      }
    }
    *cloud = new_cloud(read_cloud(name, read_options_of(options)));
  });
}

psk_code psk_mesh_write(const psk_mesh* mesh, const char* path, const psk_write_options* options, psk_error* error) {
  return guarded(error, [&] { write_mesh(&required(path, "path"), *HostMesh(mesh), write_options_of(options)); });
}

psk_code psk_mesh_copy(const psk_mesh* mesh, psk_mesh** copy, psk_error* error) {
  return psk_mesh_to_host(mesh, copy, error);
}

void psk_mesh_free(psk_mesh* mesh) { delete mesh; }

int32_t psk_mesh_memory(const psk_mesh* mesh) { return psk_mesh_gpu(mesh) < 0 ? PSK_HOST : PSK_DEVICE; }

psk_code psk_mesh_to_host(const psk_mesh* mesh, psk_mesh** copy, psk_error* error) {
  return guarded(error, [&] {
    const auto& from = required(mesh, "mesh").mesh;
    const auto* device = std::get_if<psk_mesh::OnDevice>(&from);
    required(copy, "copy") =
        new_mesh(device != nullptr ? download(device->workspace, device->mesh) : std::get<Mesh>(from));
  });
}

int64_t psk_mesh_vertex_count(const psk_mesh* mesh) { return psk_mesh_vertices(mesh).rows; }

int64_t psk_mesh_triangle_count(const psk_mesh* mesh) { return psk_mesh_triangles(mesh).rows; }

void psk_mesh_origin(const psk_mesh* mesh, double origin[3]) {
  store(look(mesh, [](const auto& from, int) { return from.origin; }), origin);
}

psk_array psk_mesh_vertices(const psk_mesh* mesh) {
  return look(mesh, [](const auto& from, int memory) { return array_of(span_of(from.vertices), memory); });
}

psk_array psk_mesh_normals(const psk_mesh* mesh) {
  return look(mesh, [](const auto& from, int memory) { return array_of(span_of(from.normals), memory); });
}

psk_array psk_mesh_triangles(const psk_mesh* mesh) {
  return look(mesh, [](const auto& from, int memory) { return array_of(span_of(from.triangles), memory); });
}

int64_t psk_mesh_attribute_count(const psk_mesh* mesh) {
  return look(mesh, [](const auto& from, int) { return static_cast<std::int64_t>(from.attributes.size()); });
}

psk_attribute psk_mesh_attribute(const psk_mesh* mesh, int64_t index) {
  if (index < 0 || index >= psk_mesh_attribute_count(mesh)) return {};
  const auto at = static_cast<std::size_t>(index);
  if (const auto* host = std::get_if<Mesh>(&mesh->mesh)) return attribute_of(host->attributes[at]);
  const DeviceMesh& device = std::get<psk_mesh::OnDevice>(mesh->mesh).mesh;
  return attribute_of(device.attributes[at], device.vertices.size, psk_mesh_memory(mesh));
}

int32_t psk_mesh_gpu(const psk_mesh* mesh) {
  if (mesh == nullptr) return -1;
  const auto* on_device = std::get_if<psk_mesh::OnDevice>(&mesh->mesh);
  if (on_device == nullptr) return -1;
  const Device& device = on_device->workspace.device();
  return device.kind == DeviceKind::cuda ? device.index : -1;
}

void* psk_mesh_stream(const psk_mesh* mesh) {
  const auto* on_device = mesh == nullptr ? nullptr : std::get_if<psk_mesh::OnDevice>(&mesh->mesh);
  return on_device == nullptr ? nullptr : on_device->workspace.stream();
}

psk_code psk_mesh_cloud(const psk_mesh* mesh, psk_cloud** cloud, psk_error* error) {
  return guarded(error, [&] {
    const HostMesh from(mesh);
    required(cloud, "cloud") = new_cloud({from->origin, from->vertices, from->normals, from->attributes, 0});
  });
}

psk_code psk_mesh_add_normals(psk_mesh* mesh, psk_error* error) {
  return guarded(error, [&] { add_vertex_normals(host_mesh(mesh)); });
}

psk_code psk_mesh_measure(const psk_mesh* mesh, int32_t threads, psk_mesh_report* report, psk_error* error) {
  return guarded(error, [&] { give(report_of(measure(*HostMesh(mesh), threads)), &required(report, "report")); });
}

psk_code psk_measure_file(const char* path, const psk_scale_options* options, psk_mesh_report* report,
                          psk_error* error) {
  return guarded(error, [&] {
    const psk_scale_options given = known(options);
    give(report_of(measure_file(&required(path, "path"), {given.max_memory_bytes, given.threads})),
         &required(report, "report"));
  });
}

psk_code psk_mesh_self_intersections(const psk_mesh* mesh, int32_t threads, int64_t* pairs, int64_t* touching,
                                     psk_error* error) {
  return guarded(error, [&] {
    const SelfIntersections found = find_self_intersections(*HostMesh(mesh), {.listed = 0, .threads = threads});
    if (pairs != nullptr) *pairs = found.pairs;
    if (touching != nullptr) *touching = found.touching;
  });
}

psk_code psk_mesh_components(const psk_mesh* mesh, int32_t threads, int32_t* of_vertex, int64_t* count,
                             psk_error* error) {
  return guarded(error, [&] {
    const MeshComponents found = label_components(*HostMesh(mesh), threads);
    if (of_vertex != nullptr) std::copy(found.of_vertex.begin(), found.of_vertex.end(), of_vertex);
    if (count != nullptr) *count = found.count;
  });
}
