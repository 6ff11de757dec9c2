#include "c/convert.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "c/defaults.hpp"

namespace pointskin::c {
namespace {

SolveOptions solve_options_of(const psk_options& from) {
  SolveOptions to;
  to.depth = from.depth;
  to.point_normals = enumerator("point_normals", from.point_normals, PointNormals::estimate);
  to.normal_estimation = normal_options_of(from.normal_estimation);
  to.field = enumerator("field", from.field, FieldKind::distance);
  to.screening = from.screening;
  to.fixed_screening = from.fixed_screening != 0;
  to.iterations = from.iterations;
  to.scale = from.scale;
  to.samples_per_node = from.samples_per_node;
  to.confidence = from.confidence != 0;
  to.boundary = enumerator("boundary", from.boundary, Boundary::dirichlet);
  if (from.envelope != nullptr) to.envelope = std::make_shared<const Mesh>(*HostMesh(from.envelope));
  to.offset = from.offset;
  to.keep_strays = from.keep_strays != 0;
  return to;
}

ExtractOptions extract_options_of(const psk_options& from) {
  ExtractOptions to;
  if (from.has_isovalue != 0) to.isovalue = from.isovalue;
  to.normals = from.normals != 0;
  to.linear_fit = from.linear_fit != 0;
  to.domain_faces = enumerator("domain_faces", from.domain_faces, DomainFaces::open);
  to.trim = from.trim;
  to.island_ratio = from.island_ratio;
  to.largest = from.largest != 0;
  to.min_component = from.min_component;
  to.density = from.density != 0;
  to.weakness = from.weakness != 0;
  to.attributes = from.attributes != 0;
  return to;
}

psk_array packed(const void* data, std::int64_t rows, int components, AttributeType type, int memory) {
  psk_array array{};
  array.data = data;
  array.rows = data == nullptr ? 0 : rows;
  array.component_stride = static_cast<std::int64_t>(size_of(type));
  array.row_stride = array.component_stride * components;
  array.components = components;
  array.type = static_cast<std::int32_t>(type);
  array.memory = memory;
  return array;
}

}  // namespace

std::function<bool(const Progress&)> progress_of(psk_progress progress, void* user) {
  if (progress == nullptr) return {};
  return [progress, user](const Progress& at) { return progress(at.phase, at.fraction, user) != 0; };
}

Options options_of(const psk_options* given) {
  const psk_options from = known(given);
  RunOptions run;
  run.residuals = from.residuals != 0;
  run.max_memory_bytes = from.max_memory_bytes;
  run.progress = progress_of(from.progress, from.user);
  return {solve_options_of(from), extract_options_of(from), run};
}

NormalOptions normal_options_of(const psk_normal_options* given) {
  const psk_normal_options from = known(given);
  NormalOptions to;
  to.method = enumerator("method", from.method, NormalMethod::repair);
  if (from.sensor_count < 0 || (from.sensors == nullptr && from.sensor_count > 0))
    throw Error(ErrorCode::usage, "sensors must be as many as sensor_count says");
  for (std::int64_t i = 0; i < from.sensor_count; ++i) to.sensors.push_back(vector_of(from.sensors + 3 * i));
  to.random_start = from.random_start != 0;
  to.seed = from.seed;
  to.max_rounds = from.max_rounds;
  to.time_limit_s = from.time_limit_s;
  to.keep_within_degrees = from.keep_within_degrees;
  to.confidence = from.confidence != 0;
  to.curvature = from.curvature != 0;
  to.progress = progress_of(from.progress, from.user);
  return to;
}

ReadOptions read_options_of(const psk_read_options* given) {
  const psk_read_options from = known(given);
  ReadOptions to;
  if (from.shift != nullptr) to.shift = vector_of(from.shift);
  to.threads = from.threads;
  return to;
}

WriteOptions write_options_of(const psk_write_options* given) {
  const psk_write_options from = known(given);
  WriteOptions to;
  to.ascii = from.ascii != 0;
  to.double_coordinates = from.double_coordinates != 0;
  to.compress = from.compress != 0;
  to.threads = from.threads;
  return to;
}

RenderOptions render_options_of(const psk_render_options* given) {
  const psk_render_options from = known(given);
  RenderOptions to;
  to.width = from.width;
  to.height = from.height;
  to.azimuth_degrees = from.azimuth_degrees;
  to.elevation_degrees = from.elevation_degrees;
  if (from.target != nullptr) to.target_world = vector_of(from.target);
  to.up = enumerator("up", from.up, UpAxis::minus_z);
  to.projection = from.orthographic != 0 ? Projection::orthographic : Projection::perspective;
  to.fit = from.fit_sphere != 0 ? Fit::sphere : Fit::box;
  if (from.fit_world != nullptr) to.fit_world = WorldBox{vector_of(from.fit_world), vector_of(from.fit_world + 3)};
  to.zoom = from.zoom;
  if (from.field_of_view_degrees != 0) to.field_of_view_degrees = from.field_of_view_degrees;
  to.smooth = from.smooth != 0;
  to.back_faces = from.back_faces != 0;
  to.colours = from.colours != 0;
  to.shadows = from.shadows != 0;
  to.wireframe = from.wireframe != 0;
  to.point_size = from.point_size;
  to.point_size_world = from.point_size_world;
  if (from.colour_by != nullptr) to.colour_by = from.colour_by;
  if (from.range != nullptr) to.range = ValueRange{from.range[0], from.range[1]};
  to.colour_map = enumerator("colour_map", from.colour_map, ColourMap::diverging);
  to.colour_bar = from.colour_bar != 0;
  to.threads = from.threads;
  return to;
}

StridedArray strided(const psk_array& array) {
  StridedArray to;
  if (array.data == nullptr && array.rows == 0) return to;
  to.data = array.data;
  to.type = enumerator("the type of an array", array.type, AttributeType::float64);
  to.rows = array.rows;
  to.components = array.components;
  const auto element = static_cast<std::int64_t>(size_of(to.type));
  const bool is_packed = array.row_stride == 0 && array.component_stride == 0;
  to.component_stride_bytes = is_packed ? element : array.component_stride;
  to.row_stride_bytes = is_packed ? element * array.components : array.row_stride;
  return to;
}

StridedPoints strided(const psk_points* points) {
  const psk_points from = known(&required(points, "points"));
  StridedPoints to;
  to.origin = vector_of(from.origin);
  to.positions = strided(from.positions);
  to.normals = strided(from.normals);
  if (from.attribute_count > 0) required(from.attributes, "attributes");
  for (std::int64_t i = 0; i < from.attribute_count; ++i) {
    const psk_attribute& attribute = from.attributes[i];
    to.attributes.push_back(
        {&required(attribute.name, "the name of an attribute"), strided(attribute.values), attribute.missing});
  }
  return to;
}

bool is_on_device(const psk_points& points) {
  const bool device = points.positions.memory == PSK_DEVICE;
  const auto differs = [device](const psk_array& array) {
    return array.data != nullptr && (array.memory == PSK_DEVICE) != device;
  };
  bool mixed = differs(points.normals);
  for (std::int64_t i = 0; i < points.attribute_count; ++i) mixed = mixed || differs(points.attributes[i].values);
  if (mixed) throw Error(ErrorCode::usage, "arrays of points must all be on the host, or all on the device");
  return device;
}

psk_array array_of(std::span<const Vec3f> values, int memory) {
  return packed(values.data(), static_cast<std::int64_t>(values.size()), 3, AttributeType::float32, memory);
}

psk_array array_of(std::span<const Triangle> values, int memory) {
  return packed(values.data(), static_cast<std::int64_t>(values.size()), 3, AttributeType::int32, memory);
}

psk_attribute attribute_of(const Attribute& attribute) {
  psk_attribute to{};
  to.name = attribute.name.c_str();
  attribute.values.visit([&](const auto& values) {
    to.values = packed(values.data(), static_cast<std::int64_t>(values.size()), 1, attribute.type(), PSK_HOST);
  });
  to.missing = attribute.values.has_mask() ? attribute.values.mask().data() : nullptr;
  return to;
}

psk_attribute attribute_of(const DeviceAttribute& attribute, std::int64_t rows, int memory) {
  return {attribute.name.c_str(), packed(attribute.data, rows, 1, attribute.type, memory), attribute.missing};
}

HostMesh::HostMesh(const psk_mesh* handle) {
  const auto& mesh = required(handle, "mesh").mesh;
  if (const auto* device = std::get_if<psk_mesh::OnDevice>(&mesh))
    copy_ = download(device->workspace, device->mesh);
  else
    mesh_ = &std::get<Mesh>(mesh);
}

MeshOrCloud::MeshOrCloud(const psk_mesh* mesh, const psk_cloud* cloud, const char* what) {
  if ((mesh == nullptr) == (cloud == nullptr))
    throw Error(ErrorCode::usage, std::string(what) + " must be either a mesh or a cloud");
  if (mesh != nullptr)
    mesh_.emplace(mesh);
  else
    cloud_ = &cloud->cloud;
}

psk_mesh* new_mesh(Mesh mesh) { return new psk_mesh{std::move(mesh)}; }

psk_mesh* new_mesh(const Workspace& workspace, DeviceMesh mesh) {
  return new psk_mesh{psk_mesh::OnDevice{workspace, std::move(mesh)}};
}

psk_mesh* new_mesh(const Workspace& workspace, DeviceMesh mesh, int memory) {
  if (memory == PSK_DEVICE) return new_mesh(workspace, std::move(mesh));
  if (memory != PSK_HOST) throw Error(ErrorCode::usage, "memory must be PSK_HOST or PSK_DEVICE");
  return new_mesh(download(workspace, mesh));
}

psk_cloud* new_cloud(Cloud cloud) { return new psk_cloud{std::move(cloud), {}, {}}; }

}  // namespace pointskin::c
