// Fuzzes reconstruction itself. Bytes 0 to 11 choose options, every nine after them are a point and its normal. A result is a
// finite mesh, closed unless options open it, with the same bytes from one thread and from two; or there is an Error.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>

#include <pointskin/cloud.hpp>
#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

using namespace pointskin;

namespace {

constexpr std::size_t kOptionBytes = 12;
constexpr std::size_t kPointBytes = 9;

/// In [-1, 1], of two bytes.
float share(const std::uint8_t* bytes) {
  std::int16_t value = 0;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<float>(value) / 32768.0F;
}

Cloud cloud_of(const std::uint8_t* data, std::size_t size, float scale, float offset) {
  Cloud cloud;
  for (; size >= kPointBytes; data += kPointBytes, size -= kPointBytes) {
    cloud.positions.push_back(
        {scale * share(data) + offset, scale * share(data + 2) + offset, scale * share(data + 4) + offset});
    const auto component = [&](std::size_t k) {
      return static_cast<float>(static_cast<std::int8_t>(data[6 + k])) / 64;
    };
    cloud.normals.push_back({component(0), component(1), component(2)});
  }
  return cloud;
}

Options options_of(const std::uint8_t* bytes, float scale) {
  constexpr std::array<double, 4> kSamplesPerNode = {1.5, 0, 0.3, 6};
  constexpr std::array<double, 4> kScreening = {2, 0, 100, 1e6};
  constexpr std::array<double, 4> kScale = {1.1, 1, 1.5, 4};
  constexpr std::array<double, 4> kOffset = {0, 0, 0.05, -0.05};
  constexpr std::array<double, 4> kTrim = {0, 0, 0.05, 0.5};
  const auto flag = [&](int bit) { return (bytes[1] >> bit & 1) != 0; };
  Options options;
  options.depth = 1 + bytes[0] % 4 + (bytes[0] >= 250 ? 2 : 0);  // deep ones are slow
  options.field = flag(0) ? FieldKind::distance : FieldKind::poisson;
  options.boundary = flag(1) ? Boundary::dirichlet : Boundary::free;
  options.confidence = flag(2);
  options.fixed_screening = flag(3);
  options.linear_fit = flag(4);
  options.keep_strays = flag(5);
  options.density = flag(6);
  options.weakness = flag(7);
  options.iterations = 1 + bytes[2] % 12;
  options.samples_per_node = kSamplesPerNode.at(bytes[3] % 4);
  options.screening = kScreening.at(bytes[4] % 4);
  options.scale = kScale.at(bytes[5] % 4);
  options.offset = kOffset.at(bytes[6] % 4) * static_cast<double>(scale);
  options.trim = kTrim.at(bytes[7] % 4);
  options.point_normals = bytes[8] % 4 == 0   ? PointNormals::automatic
                          : bytes[8] % 4 == 1 ? PointNormals::given
                          : bytes[8] % 4 == 2 ? PointNormals::repair
                                              : PointNormals::estimate;
  options.max_memory_bytes = std::int64_t{512} << 20;
  return options;
}

bool is_finite(const Vec3f& v) { return v.x - v.x == 0 && v.y - v.y == 0 && v.z - v.z == 0; }

std::optional<Mesh> made(const Cloud& cloud, const Options& options, int threads) {
  try {
    return Reconstructor(Device::cpu(threads)).reconstruct(cloud, options);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::internal) std::abort();
    return std::nullopt;
  }
}

bool are_equal(const Mesh& a, const Mesh& b) {
  return a.vertices == b.vertices && a.normals == b.normals && a.triangles == b.triangles;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < kOptionBytes + kPointBytes) return 0;
  const float scale = std::exp2(static_cast<float>(static_cast<std::int8_t>(data[9])));
  const float offset = data[10] % 4 == 0 ? scale * static_cast<float>(data[11]) : 0;
  const Cloud cloud = cloud_of(data + kOptionBytes, size - kOptionBytes, scale, offset);
  const Options options = options_of(data, scale);
  const std::optional<Mesh> mesh = made(cloud, options, 1);
  const std::optional<Mesh> again = made(cloud, options, 2);
  if (mesh.has_value() != again.has_value()) std::abort();
  if (!mesh) return 0;
  if (!are_equal(*mesh, *again)) std::abort();
  for (const Vec3f& v : mesh->vertices)
    if (!is_finite(v)) std::abort();
  for (const Vec3f& n : mesh->normals)
    if (!is_finite(n)) std::abort();
  if (options.trim > 0) return 0;
  const MeshReport report = measure(*mesh, 1);
  if (!report.closed() || !report.manifold() || !report.oriented()) std::abort();
  return 0;
}
