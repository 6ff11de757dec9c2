#include <pointskin/deform.hpp>

#include <algorithm>
#include <cstdint>

#include "c/convert.hpp"
#include "c/defaults.hpp"

using namespace pointskin;
using namespace pointskin::c;

namespace {

HandleRegion region_of(const psk_handle& from) {
  const Vec3d a = vector_of(from.a);
  const Vec3d b = vector_of(from.b);
  switch (from.region) {
    case PSK_HALF_SPACE:
      return HalfSpace{a, b};
    case PSK_BALL:
      return Ball{a, from.radius};
    case PSK_AXIS_BOX:
      return AxisBox{a, b};
    case PSK_CAPSULE:
      return Capsule{a, b, from.radius};
    case PSK_POINT_SET:
      if (from.point_count < 1) throw Error(ErrorCode::usage, "a handle of points must have at least one");
      return PointSet{{&required(from.points, "points"), from.points + from.point_count}};
    default:
      throw Error(ErrorCode::usage, "region must be in [0, 4], not " + std::to_string(from.region));
  }
}

HandleTransform transform_of(const psk_handle& from) {
  if (from.affine == 0)
    return RigidMotion{vector_of(from.axis), vector_of(from.axis_point), from.angle, vector_of(from.translation)};
  AffineMap map;
  std::copy(std::begin(from.matrix), std::end(from.matrix), map.matrix.begin());
  map.pivot = vector_of(from.pivot);
  return map;
}

Lattice lattice_of(const psk_lattice& from) {
  Lattice to;
  to.origin = vector_of(from.origin);
  for (std::size_t edge = 0; edge < 3; ++edge) {
    to.axes[edge] = vector_of(from.axes + 3 * edge);
    to.spans[edge] = from.spans[edge];
    if (to.spans[edge] < 1 || to.spans[edge] > 15)
      throw Error(ErrorCode::usage, "the spans of a lattice must be in [1, 15]");
  }
  to.outside = from.stay != 0 ? Lattice::Outside::stay : Lattice::Outside::extend;
  to.reset();
  if (from.control != nullptr)
    for (std::size_t i = 0; i < to.control.size(); ++i) to.control[i] = vector_of(from.control + 3 * i);
  return to;
}

/// Element `index` of structs in a row, each as large as the first one says.
template <class T>
T element(const T* first, std::int64_t index, const char* name) {
  const std::size_t size = required(first, name).size;
  const auto* at = reinterpret_cast<const unsigned char*>(first) + static_cast<std::size_t>(index) * size;
  return known(reinterpret_cast<const T*>(at));
}

}  // namespace

psk_code psk_deformer_create(psk_workspace* workspace, const psk_cloud* rest, const psk_options* options,
                             psk_deformer** deformer, psk_error* error) {
  return guarded(error, [&] {
    required(deformer, "deformer") = new psk_deformer{
        Deformer(required(rest, "rest").cloud, options_of(options), required(workspace, "workspace").workspace)};
  });
}

void psk_deformer_free(psk_deformer* deformer) { delete deformer; }

psk_code psk_deformer_deform(psk_deformer* deformer, const psk_handle* handles, int64_t handle_count,
                             const psk_lattice* lattices, int64_t lattice_count, double share, psk_error* error) {
  return guarded(error, [&] {
    Deformation deformation;
    for (std::int64_t i = 0; i < handle_count; ++i) {
      const psk_handle handle = element(handles, i, "handles");
      deformation.handles.push_back({region_of(handle), transform_of(handle)});
    }
    for (std::int64_t i = 0; i < lattice_count; ++i)
      deformation.lattices.push_back(lattice_of(element(lattices, i, "lattices")));
    required(deformer, "deformer").deformer.deform(share == 1 ? deformation : scaled(deformation, share));
  });
}

psk_code psk_deformer_mesh(psk_deformer* deformer, psk_mesh** mesh, psk_error* error) {
  return guarded(error,
                 [&] { required(mesh, "mesh") = new_mesh(required(deformer, "deformer").deformer.reconstruct()); });
}

psk_code psk_deformer_cloud(const psk_deformer* deformer, psk_cloud** cloud, psk_error* error) {
  return guarded(error, [&] { required(cloud, "cloud") = new_cloud(required(deformer, "deformer").deformer.cloud()); });
}

psk_code psk_deformer_report(const psk_deformer* deformer, psk_deform_report* report, psk_error* error) {
  return guarded(error, [&] {
    const DeformReport& from = required(deformer, "deformer").deformer.report();
    auto to = defaults<psk_deform_report>();
    to.rest_points = from.rest_points;
    to.points = from.points;
    to.inserted = from.inserted;
    to.thinned = from.thinned;
    to.upload_ms = from.upload_ms;
    to.rest_ms = from.rest_ms;
    to.sample_ms = from.sample_ms;
    to.map_ms = from.map_ms;
    to.mesh_ms = from.mesh_ms;
    give(to, &required(report, "report"));
  });
}
