// The C interface, called through the shared library as another program calls it.
#include <gtest/gtest.h>

#include <pointskin/c.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace {

/// Points on the unit sphere, by the golden angle, with their normals.
std::vector<float> sphere(int count) {
  std::vector<float> xyz;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double r = std::sqrt(1 - z * z);
    const double a = 2.399963229728653 * i;
    for (const double value : {r * std::cos(a), r * std::sin(a), z}) xyz.push_back(static_cast<float>(value));
  }
  return xyz;
}

template <class T>
psk_array array_of(const T* data, std::int64_t rows, int type, std::int64_t row_stride = 0,
                   std::int64_t component_stride = 0) {
  return {data, rows, row_stride, component_stride, 3, type, PSK_HOST, 0};
}

psk_points points_of(const std::vector<float>& xyz) {
  psk_points points;
  psk_init(PSK_STRUCT_POINTS, &points, sizeof(points), nullptr);
  points.positions = array_of(xyz.data(), static_cast<std::int64_t>(xyz.size() / 3), PSK_FLOAT32);
  points.normals = points.positions;
  return points;
}

psk_options options_of(int depth) {
  psk_options options;
  psk_init(PSK_STRUCT_OPTIONS, &options, sizeof(options), nullptr);
  options.depth = depth;
  return options;
}

/// A workspace on the CPU and a reconstructor in it.
struct Session {
  psk_workspace* workspace = nullptr;
  psk_reconstructor* reconstructor = nullptr;
  psk_error error{};

  Session() {
    psk_workspace_create("cpu", 2, &workspace, &error);
    psk_reconstructor_create(workspace, &reconstructor, &error);
  }
  ~Session() {
    psk_reconstructor_free(reconstructor);
    psk_workspace_free(workspace);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  psk_mesh* mesh(const psk_points& points, const psk_options& options) {
    psk_mesh* made = nullptr;
    EXPECT_EQ(psk_reconstruct_points(reconstructor, &points, &options, PSK_HOST, &made, &error), PSK_OK)
        << error.message;
    return made;
  }
};

/// All numbers of a mesh's vertices and triangles.
std::string bytes_of(psk_mesh* mesh) {
  std::string bytes;
  for (const psk_array& array : {psk_mesh_vertices(mesh), psk_mesh_normals(mesh), psk_mesh_triangles(mesh)})
    bytes.append(static_cast<const char*>(array.data), static_cast<std::size_t>(array.rows * array.row_stride));
  psk_mesh_free(mesh);
  return bytes;
}

TEST(CInterface, KnowsItsVersionAndTheSizesOfItsStructs) {
  EXPECT_EQ(psk_c_abi(), PSK_C_ABI);
  EXPECT_STREQ(psk_version(), "0.1.0");
  EXPECT_EQ(psk_struct_size(PSK_STRUCT_OPTIONS), sizeof(psk_options));
  for (int kind = 1; kind <= PSK_STRUCT_COUNT; ++kind) EXPECT_GT(psk_struct_size(kind), sizeof(std::size_t)) << kind;
  EXPECT_EQ(psk_struct_size(0), 0U);
  EXPECT_EQ(psk_struct_size(PSK_STRUCT_COUNT + 1), 0U);
}

TEST(CInterface, ArraysOfAnyTypeAndStridesGiveTheSameMesh) {
  Session session;
  const std::vector<float> packed = sphere(3000);
  const psk_options options = options_of(5);
  const std::string expected = bytes_of(session.mesh(points_of(packed), options));
  ASSERT_GT(expected.size(), 10000U);

  const std::vector<double> doubles(packed.begin(), packed.end());
  psk_points points = points_of(packed);
  points.positions = array_of(doubles.data(), 3000, PSK_FLOAT64);
  EXPECT_EQ(bytes_of(session.mesh(points, options)), expected) << "doubles";

  std::vector<float> columns(9000);  // x of all, then y, then z
  for (std::size_t i = 0; i < 9000; ++i) columns[i % 3 * 3000 + i / 3] = packed[i];
  points.positions = array_of(columns.data(), 3000, PSK_FLOAT32, 4, 12000);
  EXPECT_EQ(bytes_of(session.mesh(points, options)), expected) << "columns";

  std::vector<float> backwards(packed);  // the last point first, walked through from its end
  for (std::size_t i = 0; i < 3000; ++i) std::memcpy(&backwards[3 * i], &packed[3 * (2999 - i)], 12);
  points.positions = array_of(&backwards[8997], 3000, PSK_FLOAT32, -12, 4);
  EXPECT_EQ(bytes_of(session.mesh(points, options)), expected) << "backwards";

  std::vector<unsigned char> unaligned(36001);
  std::memcpy(unaligned.data() + 1, packed.data(), 36000);
  points.positions = array_of(unaligned.data() + 1, 3000, PSK_FLOAT32);
  EXPECT_EQ(bytes_of(session.mesh(points, options)), expected) << "unaligned";
}

TEST(CInterface, PointsThatAreNotFiniteAreLeftOut) {
  Session session;
  std::vector<float> xyz = sphere(3000);
  const psk_options options = options_of(5);
  const std::string expected = bytes_of(session.mesh(points_of(xyz), options));
  std::vector<float> normals = xyz;
  xyz.insert(xyz.end(), {std::numeric_limits<float>::quiet_NaN(), 0, 0});
  normals.insert(normals.end(), {0, 0, 1});
  psk_points points = points_of(xyz);
  points.normals = array_of(normals.data(), 3001, PSK_FLOAT32);
  EXPECT_EQ(bytes_of(session.mesh(points, options)), expected);

  psk_cloud* cloud = nullptr;
  ASSERT_EQ(psk_cloud_create(&points, nullptr, &cloud, nullptr), PSK_OK);
  EXPECT_EQ(psk_cloud_size(cloud), 3000);
  EXPECT_EQ(psk_cloud_dropped(cloud), 1);
  psk_cloud_free(cloud);
}

TEST(CInterface, LargeCoordinatesKeepTheirDigits) {
  const double lower[3] = {431000.123, 5412345.678, 812.25};
  std::vector<double> xyz;
  for (const float value : sphere(100)) xyz.push_back(lower[xyz.size() % 3] + static_cast<double>(value));
  psk_points points;
  psk_init(PSK_STRUCT_POINTS, &points, sizeof(points), nullptr);
  points.positions = array_of(xyz.data(), 100, PSK_FLOAT64);
  psk_cloud* cloud = nullptr;
  ASSERT_EQ(psk_cloud_create(&points, nullptr, &cloud, nullptr), PSK_OK);
  double origin[3];
  psk_cloud_origin(cloud, origin);
  const auto* positions = static_cast<const float*>(psk_cloud_positions(cloud).data);
  for (std::size_t i = 0; i < xyz.size(); ++i)
    EXPECT_NEAR(origin[i % 3] + static_cast<double>(positions[i]), xyz[i], 1e-6);
  psk_cloud_free(cloud);
}

TEST(CInterface, AttributesTravelAndMayBeMissing) {
  Session session;
  const std::vector<float> xyz = sphere(500);
  std::vector<std::uint8_t> classes(500, 3), missing(500, 0);
  classes[7] = 9;
  missing[8] = 1;
  psk_attribute attribute{"class", array_of(classes.data(), 500, PSK_UINT8), missing.data()};
  attribute.values.components = 1;
  psk_points points = points_of(xyz);
  points.attributes = &attribute;
  points.attribute_count = 1;
  psk_cloud* cloud = nullptr;
  ASSERT_EQ(psk_cloud_create(&points, nullptr, &cloud, nullptr), PSK_OK);
  ASSERT_EQ(psk_cloud_attribute_count(cloud), 1);
  const psk_attribute kept = psk_cloud_attribute(cloud, 0);
  EXPECT_STREQ(kept.name, "class");
  EXPECT_EQ(static_cast<const std::uint8_t*>(kept.values.data)[7], 9);
  ASSERT_NE(kept.missing, nullptr);
  EXPECT_EQ(kept.missing[8], 1);
  EXPECT_EQ(psk_cloud_attribute(cloud, 1).name, nullptr);
  psk_cloud_free(cloud);
}

TEST(CInterface, ErrorsHaveACodeAndAStory) {
  Session session;
  psk_error error{};
  psk_mesh* mesh = nullptr;
  const std::vector<float> xyz = sphere(100);
  psk_points points = points_of(xyz);
  psk_options options = options_of(99);
  EXPECT_EQ(psk_reconstruct_points(session.reconstructor, &points, &options, PSK_DEVICE, &mesh, &error), PSK_USAGE);
  EXPECT_NE(std::string(error.message).find("depth"), std::string::npos) << error.message;
  EXPECT_EQ(error.code, PSK_USAGE);
  EXPECT_EQ(mesh, nullptr);
  options = options_of(5);
  points.normals = {};
  options.point_normals = PSK_POINT_NORMALS_GIVEN;
  EXPECT_EQ(psk_reconstruct_points(session.reconstructor, &points, &options, PSK_DEVICE, &mesh, &error),
            PSK_NO_NORMALS);
  points = points_of(xyz);
  points.positions.components = 2;
  EXPECT_EQ(psk_reconstruct_points(session.reconstructor, &points, &options, PSK_DEVICE, &mesh, &error), PSK_USAGE);
  EXPECT_EQ(psk_reconstruct_points(session.reconstructor, nullptr, &options, PSK_DEVICE, &mesh, &error), PSK_USAGE);
  EXPECT_STREQ(error.message, "points must not be null");
  EXPECT_EQ(psk_mesh_read("/no/such/file.ply", nullptr, &mesh, &error), PSK_INVALID_INPUT);
  EXPECT_EQ(psk_mesh_read("/no/such/file.ply", nullptr, &mesh, nullptr), PSK_INVALID_INPUT);
  psk_workspace* workspace = nullptr;
  EXPECT_EQ(psk_workspace_create("toaster", 0, &workspace, &error), PSK_USAGE);
  const std::string longest(5000, 'a');
  EXPECT_EQ(psk_mesh_read(longest.c_str(), nullptr, &mesh, &error), PSK_INVALID_INPUT);
  EXPECT_EQ(std::strlen(error.message), sizeof(error.message) - 1) << "cut off, and ended";
}

TEST(CInterface, NothingAndNullAreHarmless) {
  psk_mesh_free(nullptr);
  psk_cloud_free(nullptr);
  psk_workspace_free(nullptr);
  EXPECT_EQ(psk_mesh_vertex_count(nullptr), 0);
  EXPECT_EQ(psk_cloud_positions(nullptr).data, nullptr);
  EXPECT_EQ(psk_workspace_gpu(nullptr), -1);
  EXPECT_EQ(psk_init(PSK_STRUCT_OPTIONS, nullptr, 8, nullptr), PSK_USAGE);
  psk_options options;
  EXPECT_EQ(psk_init(1000, &options, sizeof(options), nullptr), PSK_USAGE);
  EXPECT_EQ(psk_init(PSK_STRUCT_OPTIONS, &options, 4, nullptr), PSK_USAGE);
}

/// psk_options as a first version might have had it: it ends behind `depth`.
struct OldOptions {
  std::size_t size;
  const psk_normal_options* normal_estimation;
  const psk_mesh* envelope;
  double screening, scale, samples_per_node, offset;
  std::int32_t depth;
};

TEST(CInterface, ACallerOfAnOlderStructWorks) {
  static_assert(offsetof(OldOptions, depth) == offsetof(psk_options, depth));
  static_assert(sizeof(OldOptions) < sizeof(psk_options));
  Session session;
  const std::vector<float> xyz = sphere(3000);
  const psk_points points = points_of(xyz);
  const std::string expected = bytes_of(session.mesh(points, options_of(6)));
  struct {
    OldOptions options;
    unsigned char behind[64];
  } old{};
  std::memset(old.behind, 0xAB, sizeof(old.behind));
  ASSERT_EQ(psk_init(PSK_STRUCT_OPTIONS, &old.options, sizeof(old.options), nullptr), PSK_OK);
  EXPECT_EQ(old.behind[0], 0xAB) << "no byte behind the caller's struct is written";
  EXPECT_EQ(old.options.size, sizeof(OldOptions));
  EXPECT_EQ(old.options.depth, 8);
  old.options.depth = 6;
  psk_mesh* mesh = nullptr;
  ASSERT_EQ(psk_reconstruct_points(session.reconstructor, &points, reinterpret_cast<const psk_options*>(&old.options),
                                   PSK_DEVICE, &mesh, &session.error),
            PSK_OK)
      << session.error.message;
  EXPECT_EQ(bytes_of(mesh), expected) << "what it does not know has its default, not the bytes behind it";
}

TEST(CInterface, AReportWritesNoMoreThanItsCallerHas) {
  Session session;
  const std::vector<float> xyz = sphere(1000);
  psk_mesh* mesh = session.mesh(points_of(xyz), options_of(4));
  struct {
    std::size_t size;
    std::int64_t vertices;
    unsigned char behind[256];
  } old{};
  old.size = 16;
  std::memset(old.behind, 0xCD, sizeof(old.behind));
  ASSERT_EQ(psk_mesh_measure(mesh, 0, reinterpret_cast<psk_mesh_report*>(&old), nullptr), PSK_OK);
  EXPECT_EQ(old.vertices, psk_mesh_vertex_count(mesh));
  EXPECT_EQ(old.size, 16U);
  for (const unsigned char byte : old.behind) ASSERT_EQ(byte, 0xCD);
  old.size = 0;
  EXPECT_EQ(psk_mesh_measure(mesh, 0, reinterpret_cast<psk_mesh_report*>(&old), nullptr), PSK_USAGE);
  psk_mesh_free(mesh);
}

TEST(CInterface, AFileIsMeasuredInPartsWhereMemoryIsLimited) {
  Session session;
  const std::vector<float> xyz = sphere(3000);
  psk_mesh* mesh = session.mesh(points_of(xyz), options_of(7));
  const std::string path = testing::TempDir() + "pointskin_measured.ply";
  ASSERT_EQ(psk_mesh_write(mesh, path.c_str(), nullptr, &session.error), PSK_OK) << session.error.message;
  psk_mesh_report whole, parts;
  psk_init(PSK_STRUCT_MESH_REPORT, &whole, sizeof(whole), nullptr);
  psk_init(PSK_STRUCT_MESH_REPORT, &parts, sizeof(parts), nullptr);
  ASSERT_EQ(psk_mesh_measure(mesh, 0, &whole, nullptr), PSK_OK);
  psk_mesh_free(mesh);
  EXPECT_TRUE(whole.watertight);
  ASSERT_EQ(psk_measure_file(path.c_str(), nullptr, &parts, nullptr), PSK_OK);
  EXPECT_EQ(std::memcmp(&parts, &whole, sizeof(whole)), 0);

  psk_scale_options options;
  psk_init(PSK_STRUCT_SCALE_OPTIONS, &options, sizeof(options), nullptr);
  EXPECT_EQ(options.max_memory_bytes, 0);
  options.max_memory_bytes = 1;
  EXPECT_EQ(psk_measure_file(path.c_str(), &options, &parts, &session.error), PSK_OVER_LIMIT);
  options.max_memory_bytes = 1'500'000;  // a third of what the whole takes
  options.threads = 1;
  ASSERT_EQ(psk_measure_file(path.c_str(), &options, &parts, &session.error), PSK_OK) << session.error.message;
  EXPECT_EQ(std::memcmp(&parts, &whole, sizeof(whole)), 0);
  EXPECT_EQ(psk_measure_file(nullptr, &options, &parts, nullptr), PSK_USAGE);
  EXPECT_EQ(psk_measure_file(path.c_str(), &options, nullptr, nullptr), PSK_USAGE);
  std::remove(path.c_str());
  EXPECT_EQ(psk_measure_file(path.c_str(), &options, &parts, nullptr), PSK_INVALID_INPUT);
}

TEST(CInterface, ACallerOfANewerStructIsRefusedWhereItAsksForMore) {
  struct {
    psk_options options;
    std::int64_t unknown;
  } newer{};
  ASSERT_EQ(psk_init(PSK_STRUCT_OPTIONS, &newer, sizeof(newer), nullptr), PSK_OK);
  newer.options.depth = 4;
  Session session;
  const std::vector<float> xyz = sphere(500);
  const psk_points points = points_of(xyz);
  psk_mesh* mesh = nullptr;
  EXPECT_EQ(psk_reconstruct_points(session.reconstructor, &points, &newer.options, PSK_DEVICE, &mesh, nullptr), PSK_OK);
  psk_mesh_free(mesh);
  newer.unknown = 1;
  EXPECT_EQ(psk_reconstruct_points(session.reconstructor, &points, &newer.options, PSK_DEVICE, &mesh, nullptr),
            PSK_USAGE);
}

TEST(CInterface, ProgressIsToldAndCancels) {
  Session session;
  const std::vector<float> xyz = sphere(3000);
  const psk_points points = points_of(xyz);
  psk_options options = options_of(6);
  std::vector<double> fractions;
  options.user = &fractions;
  options.progress = [](const char* phase, double fraction, void* user) -> std::int32_t {
    EXPECT_NE(phase, nullptr);
    static_cast<std::vector<double>*>(user)->push_back(fraction);
    return 1;
  };
  psk_mesh_free(session.mesh(points, options));
  ASSERT_GT(fractions.size(), 3U);
  EXPECT_GE(fractions.back(), fractions.front());
  options.progress = [](const char*, double, void*) -> std::int32_t { return 0; };
  psk_mesh* mesh = nullptr;
  EXPECT_EQ(psk_reconstruct_points(session.reconstructor, &points, &options, PSK_DEVICE, &mesh, nullptr),
            PSK_INTERRUPTED);
}

TEST(CInterface, FieldsHaveValuesAndSeveralExtractions) {
  Session session;
  const std::vector<float> xyz = sphere(3000);
  const psk_points points = points_of(xyz);
  const psk_options options = options_of(6);
  psk_field* field = nullptr;
  ASSERT_EQ(psk_solve_points(session.reconstructor, &points, &options, &field, &session.error), PSK_OK);
  const double places[6] = {0, 0, 0, 1.04, 0, 0};
  const psk_array array = array_of(places, 2, PSK_FLOAT64);
  float values[2];
  ASSERT_EQ(psk_field_values(field, &array, values, nullptr), PSK_OK);
  EXPECT_GT(values[0], 0.9F) << "inside";
  EXPECT_LT(values[1], 0.3F) << "outside";
  psk_mesh *first = nullptr, *second = nullptr;
  ASSERT_EQ(psk_field_extract(field, &options, PSK_HOST, &first, nullptr), PSK_OK);
  psk_options lower = options;
  lower.has_isovalue = 1;
  lower.isovalue = psk_field_isovalue(field) - 0.2;
  ASSERT_EQ(psk_field_extract(field, &lower, PSK_HOST, &second, nullptr), PSK_OK);
  psk_mesh_report a, b;
  psk_init(PSK_STRUCT_MESH_REPORT, &a, sizeof(a), nullptr);
  psk_init(PSK_STRUCT_MESH_REPORT, &b, sizeof(b), nullptr);
  psk_mesh_measure(first, 0, &a, nullptr);
  psk_mesh_measure(second, 0, &b, nullptr);
  EXPECT_TRUE(a.watertight);
  EXPECT_GT(b.volume, a.volume);
  EXPECT_EQ(bytes_of(first), bytes_of(session.mesh(points, options)));
  psk_mesh_free(second);
  psk_field_free(field);
}

TEST(CInterface, ThreadsHaveWorkspacesOfTheirOwn) {
  const std::vector<float> xyz = sphere(3000);
  const psk_options options = options_of(6);
  Session session;
  const std::string expected = bytes_of(session.mesh(points_of(xyz), options));
  std::vector<std::string> results(4);
  std::vector<std::thread> threads;
  for (std::string& result : results)
    threads.emplace_back([&] {
      Session own;
      for (int i = 0; i < 5; ++i) result = bytes_of(own.mesh(points_of(xyz), options));
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& result : results) EXPECT_EQ(result, expected);
}

}  // namespace
