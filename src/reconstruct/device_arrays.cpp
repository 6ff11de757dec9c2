// Points in arrays on a device: used where they lie, or packed.
#include <pointskin/arrays.hpp>
#include <pointskin/error.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "exec/any_space.hpp"
#include "reconstruct/pack.hpp"

namespace pointskin {
namespace {

/// What had to be packed.
struct Packed {
  Workspace workspace;  // goes last
  exec::Buffer<Vec3f> positions, normals;
  std::vector<exec::Buffer<std::uint8_t>> attributes;
};

void check_shape(const std::string& what, const StridedArray& array, std::int64_t rows, int components) {
  if (array.rows != rows || array.components != components || (array.data == nullptr && rows > 0))
    throw Error(ErrorCode::usage, what + " must have the shape (" + std::to_string(rows) + ", " +
                                      std::to_string(components) + "), not (" + std::to_string(array.rows) + ", " +
                                      std::to_string(array.components) + ")");
}

template <exec::Space Exec>
DeviceSpan<const Vec3f> triples(Exec& ex, const StridedArray& array, exec::Buffer<Vec3f>& packed) {
  if (array.type == AttributeType::float32 && array.is_packed())
    return {static_cast<const Vec3f*>(array.data), array.rows};
  packed = detail::pack_triples(ex, array);
  return {packed.data(), packed.size()};
}

template <exec::Space Exec>
DeviceAttribute attribute(Exec& ex, const StridedAttribute& from, Packed& packed) {
  DeviceAttribute to{from.name, from.values.type, from.values.data, from.missing};
  if (!from.values.is_packed()) {
    packed.attributes.push_back(detail::pack_column(ex, from.values));
    to.data = packed.attributes.back().data();
  }
  return to;
}

}  // namespace

UploadedCloud device_points_of(const Workspace& workspace, const StridedPoints& points) {
  const std::int64_t rows = points.positions.rows;
  check_shape("positions", points.positions, rows, 3);
  if (points.normals.exists()) check_shape("normals", points.normals, rows, 3);
  for (const StridedAttribute& from : points.attributes)
    check_shape("the attribute " + from.name, from.values, rows, 1);
  return exec::visit(workspace.data().space, [&](auto& ex) {
    const auto packed = std::make_shared<Packed>(Packed{workspace, {}, {}, {}});
    UploadedCloud cloud;
    cloud.origin = points.origin;
    cloud.positions = triples(ex, points.positions, packed->positions);
    if (points.normals.exists()) cloud.normals = triples(ex, points.normals, packed->normals);
    for (const StridedAttribute& from : points.attributes) cloud.attributes.push_back(attribute(ex, from, *packed));
    cloud.owner = packed;
    return cloud;
  });
}

}  // namespace pointskin
