#include "io/meshopt.hpp"

#include <array>
#include <cstdint>

#include <meshoptimizer.h>

#include "io/source.hpp"

namespace pointskin::io {
namespace {

/// The most that a coding shrinks: sixteen equal bytes of attributes to a quarter of a byte.
constexpr std::size_t kMost = 64;
constexpr std::size_t kMostStride = 256;

const unsigned char* bytes_of(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

int decode(std::string& to, std::string_view packed, const MeshoptRows& rows) {
  switch (rows.mode) {
    case MeshoptMode::attributes:
      return meshopt_decodeVertexBuffer(to.data(), rows.count, rows.stride, bytes_of(packed), packed.size());
    case MeshoptMode::triangles:
      return meshopt_decodeIndexBuffer(to.data(), rows.count, rows.stride, bytes_of(packed), packed.size());
    case MeshoptMode::indices:
      return meshopt_decodeIndexSequence(to.data(), rows.count, rows.stride, bytes_of(packed), packed.size());
  }
  return -1;
}

void undo_filter(std::string& values, const MeshoptRows& rows) {
  if (rows.filter == MeshoptFilter::octahedral) meshopt_decodeFilterOct(values.data(), rows.count, rows.stride);
  if (rows.filter == MeshoptFilter::quaternion) meshopt_decodeFilterQuat(values.data(), rows.count, rows.stride);
  if (rows.filter == MeshoptFilter::exponential) meshopt_decodeFilterExp(values.data(), rows.count, rows.stride);
}

}  // namespace

bool MeshoptRows::is_valid() const {
  if (mode != MeshoptMode::attributes)
    return filter == MeshoptFilter::none && (stride == 2 || stride == 4) &&
           (mode != MeshoptMode::triangles || count % 3 == 0);
  if (stride == 0 || stride % 4 != 0 || stride > kMostStride) return false;
  if (filter == MeshoptFilter::octahedral) return stride == 4 || stride == 8;
  return filter != MeshoptFilter::quaternion || stride == 8;
}

std::string encode_rows(const std::string& rows, std::size_t stride) {
  meshopt_encodeVertexVersion(0);  // the extension's; a setting of the whole process that nothing else changes
  const std::size_t count = rows.size() / stride;
  std::string packed(meshopt_encodeVertexBufferBound(count, stride), '\0');
  auto* to = reinterpret_cast<unsigned char*>(packed.data());
  packed.resize(meshopt_encodeVertexBuffer(to, packed.size(), rows.data(), count, stride));
  return packed;
}

std::string encode_triangles(const std::vector<Triangle>& triangles, std::size_t vertices) {
  static_assert(sizeof(Triangle) == 3 * sizeof(unsigned));
  meshopt_encodeIndexVersion(1);
  const auto* indices = reinterpret_cast<const unsigned*>(triangles.data());
  const std::size_t count = 3 * triangles.size();
  std::string packed(meshopt_encodeIndexBufferBound(count, vertices), '\0');
  auto* to = reinterpret_cast<unsigned char*>(packed.data());
  packed.resize(meshopt_encodeIndexBuffer(to, packed.size(), indices, count));
  return packed;
}

void store_octahedral(const Vec3f& direction, char* to) {
  constexpr int kBits = 12;
  const std::array<float, 4> padded{direction.x, direction.y, direction.z, 0};
  meshopt_encodeFilterOct(to, 1, 4 * sizeof(std::int16_t), kBits, padded.data());
}

std::optional<std::string> decode_rows(std::string_view packed, const MeshoptRows& rows) {
  if (!rows.is_valid() || !fits(rows.count, rows.stride, kMost * packed.size())) return std::nullopt;
  std::string values(rows.count * rows.stride, '\0');
  if (rows.count > 0 && decode(values, packed, rows) != 0) return std::nullopt;
  undo_filter(values, rows);
  return values;
}

}  // namespace pointskin::io
