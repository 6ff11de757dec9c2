#include "support/blocks_against_whole.hpp"

#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "diagnose/verdict.hpp"
#include "exec/any_space.hpp"
#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "scale/block_run.hpp"
#include "scale/cloud_extent.hpp"
#include "scale/sorted_cloud.hpp"
#include "scale/team.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"
#include "support/thread_ranks.hpp"

namespace pointskin::test {
namespace {

constexpr std::int64_t kMostPoints = 40'000;

void add(Cloud& cloud, const Vec3d& p, const Vec3d& n) {
  const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  cloud.positions.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  cloud.normals.push_back(
      {static_cast<float>(n.x / length), static_cast<float>(n.y / length), static_cast<float>(n.z / length)});
}

/// A tube around a trefoil.
Cloud knot_cloud(std::int64_t n, Random& random) {
  const auto middle = [](double t) {
    return Vec3d{(2 + std::cos(3 * t)) * std::cos(2 * t), (2 + std::cos(3 * t)) * std::sin(2 * t), std::sin(3 * t)};
  };
  const auto cross = [](const Vec3d& a, const Vec3d& b) {
    return Vec3d{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  };
  const auto unit = [](const Vec3d& v) { return v * (1 / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z)); };
  Cloud cloud;
  while (cloud.size() < n) {
    constexpr double kStep = 1e-4, kRadius = 0.3;
    const double t = 2 * std::numbers::pi * random.unit(), angle = 2 * std::numbers::pi * random.unit();
    const Vec3d along = unit(middle(t + kStep) - middle(t - kStep));
    const Vec3d side = unit(cross(along, {0.1, 0.2, 1}));
    const Vec3d normal = side * std::cos(angle) + cross(along, side) * std::sin(angle);
    add(cloud, middle(t) + normal * kRadius, normal);
  }
  return cloud;
}

/// What of a gyroid lies in a ball: it ends there.
Cloud gyroid_cloud(std::int64_t n, Random& random) {
  Cloud cloud;
  while (cloud.size() < n) {
    const auto coordinate = [&] { return 10 * random.unit() - 5; };
    Vec3d p{coordinate(), coordinate(), coordinate()};
    Vec3d gradient{};
    for (int step = 0; step < 6; ++step) {
      const double value =
          std::sin(p.x) * std::cos(p.y) + std::sin(p.y) * std::cos(p.z) + std::sin(p.z) * std::cos(p.x);
      gradient = {std::cos(p.x) * std::cos(p.y) - std::sin(p.z) * std::sin(p.x),
                  std::cos(p.y) * std::cos(p.z) - std::sin(p.x) * std::sin(p.y),
                  std::cos(p.z) * std::cos(p.x) - std::sin(p.y) * std::sin(p.z)};
      p = p - gradient * (value / (0.1 + dot(gradient, gradient)));
    }
    if (dot(p, p) < 25) add(cloud, p, gradient);
  }
  return cloud;
}

Cloud without(const Cloud& cloud, const std::function<bool(std::size_t)>& goes) {
  Cloud rest;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    if (goes(i)) continue;
    rest.positions.push_back(cloud.positions[i]);
    rest.normals.push_back(cloud.normals[i]);
  }
  return rest;
}

/// A scan, thinned; none if it is not there.
std::optional<Cloud> scan(const char* name) {
  const std::filesystem::path path = std::filesystem::path(POINTSKIN_SOURCE_DIR) / ".." / "shared" / "data" / name;
  if (!std::filesystem::exists(path)) return std::nullopt;
  const Cloud all = read_cloud(path.string());
  const auto of = static_cast<std::size_t>(1 + all.size() / kMostPoints);
  return without(all, [&](std::size_t i) { return i % of != 0; });
}

Cloud choose_cloud(Random& random, std::string& name) {
  const std::int64_t n = 8000 + random.below(16000);
  switch (random.below(10)) {
    case 0:
      return name = "knot", knot_cloud(n, random);
    case 1:
      return name = "gyroid", gyroid_cloud(n, random);
    case 2: {
      name = "noisy sphere, thinned on one side";
      const Cloud cloud = jittered(sphere_cloud(2 * n, 2), 3, 0.004);
      return without(cloud, [&](std::size_t i) { return cloud.positions[i].x > 0 && i % 200 != 0; });
    }
    case 3: {
      name = "torus with strays";
      Cloud cloud = torus_cloud(n, 4);
      append(cloud, scaled(jittered(box_cloud(60, 5), 6, 0.4), 1.5F));
      return cloud;
    }
    case 4: {
      name = "linked tori, many points twice";
      Cloud cloud = linked_tori_cloud(n, 7);
      append(cloud, without(cloud, [](std::size_t i) { return i % 3 != 0; }));
      return cloud;
    }
    case 5:
      return name = "thin plate", thin_plate_cloud(n, 8, 0.03);
    case 6: {
      name = "sphere with a hole";
      const Cloud cloud = sphere_cloud(2 * n, 9);
      return without(cloud, [&](std::size_t i) { return cloud.positions[i].z > 0.4F + 0.3F * cloud.positions[i].x; });
    }
    case 7:
      if (auto cloud = scan("bunny_scans.ply")) return name = "bunny_scans", *cloud;
      return name = "box", box_cloud(n, 10);
    case 8:
      if (auto cloud = scan("srb_dc.ply")) return name = "srb_dc", *cloud;
      return name = "noisy box", jittered(box_cloud(n, 11), 12, 0.004);
    default:
      if (auto cloud = scan("cgal_building.ply"); cloud && cloud->has_normals()) return name = "cgal_building", *cloud;
      return name = "two spheres", two_spheres_cloud(n, 13, 0.02);
  }
}

Options choose_options(Random& random, std::string& words) {
  Options options;
  options.point_normals = PointNormals::given;  // what a run does besides fitting and extracting is left out
  options.keep_strays = true;
  const auto say = [&](const std::string& what) { words += (words.empty() ? "" : ", ") + what; };
  const int depths[] = {7, 8, 8, 9}, iterations[] = {4, 8, 16};
  options.depth = depths[random.below(4)];
  options.iterations = iterations[random.below(3)];
  say("depth " + std::to_string(options.depth));
  say(std::to_string(options.iterations) + " iterations");
  const auto chance = [&](int of, const char* name, const auto& change) {
    if (random.below(of) > 0) return;
    change();
    say(name);
  };
  chance(5, "no screening", [&] { options.screening = 0; });
  chance(6, "fixed screening", [&] { options.fixed_screening = true; });
  chance(5, "confidence", [&] { options.confidence = true; });
  chance(5, "dirichlet", [&] { options.boundary = Boundary::dirichlet; });
  chance(4, "open", [&] { options.domain_faces = DomainFaces::open; });
  chance(3, "density", [&] { options.density = true; });
  chance(6, "linear fit", [&] { options.linear_fit = true; });
  chance(6, "isovalue", [&] { options.isovalue = 0.45; });
  chance(5, "largest", [&] { options.largest = true; });
  if (!options.largest) chance(5, "pieces from 100 on", [&] { options.min_component = 100; });
  const double trims[] = {0.005, 0.03, 0.2, Options::kAutomaticTrim};
  chance(2, "trim", [&] { options.trim = trims[random.below(4)]; });
  if (options.trim != 0) say(std::to_string(options.trim));
  chance(4, "all islands", [&] { options.island_ratio = 0; });
  chance(2, "attributes", [&] { options.attributes = true; });
  return options;
}

/// Colours, two that some points have no value of, and labels.
void add_attributes(Random& random, Cloud& cloud) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::uint8_t> red, green, blue;
  std::vector<float> heat;
  std::vector<std::uint16_t> intensity;
  std::vector<double> time;
  std::vector<std::uint8_t> label;
  std::vector<std::int32_t> segment;
  for (const Vec3f& p : cloud.positions) {
    red.push_back(static_cast<std::uint8_t>(random.below(256)));
    green.push_back(p.y > 0 ? 255 : 0);
    blue.push_back(7);
    heat.push_back(p.x > 0 || random.below(3) == 0 ? p.z + static_cast<float>(random.unit()) : kNone);
    intensity.push_back(static_cast<std::uint16_t>(random.below(1 << 16)));
    time.push_back(random.below(50) == 0 ? double{kNone} : 1e9 + random.unit());
    label.push_back(static_cast<std::uint8_t>(random.below(256)));
    segment.push_back(static_cast<std::int32_t>(random.below(1 << 30)) - (1 << 29));
  }
  cloud.attributes = {{"red", red},   {"green", green},         {"label", label}, {"blue", blue},
                      {"heat", heat}, {"intensity", intensity}, {"time", time},   {"segment", segment}};
}

/// A surface, whole or of blocks.
struct Found {
  std::vector<Vec3f> vertices, normals;
  std::vector<float> density;
  std::vector<Attribute> attributes;
  std::vector<Triangle> triangles;
};

template <class T>
std::size_t differing(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return std::max(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof(T)) != 0 ? 1 : 0;
  return count;
}

void expect_same(const Found& found, const Found& whole) {
  EXPECT_EQ(differing(found.vertices, whole.vertices), 0U);
  EXPECT_EQ(differing(found.normals, whole.normals), 0U);
  EXPECT_EQ(differing(found.density, whole.density), 0U);
  EXPECT_EQ(differing(found.triangles, whole.triangles), 0U);
  ASSERT_EQ(found.attributes.size(), whole.attributes.size());
  for (std::size_t i = 0; i < whole.attributes.size(); ++i) {
    EXPECT_EQ(found.attributes[i].name, whole.attributes[i].name);
    EXPECT_TRUE(found.attributes[i].values == whole.attributes[i].values) << whole.attributes[i].name;
  }
}

void expect_same(const scale::BlockReport& found, const RunReport& whole) {
  EXPECT_EQ(found.isovalue, whole.isovalue);
  EXPECT_EQ(found.pieces.pieces, whole.pieces.pieces);
  EXPECT_EQ(found.pieces.pieces_removed, whole.pieces.pieces_removed);
  EXPECT_EQ(found.trim, whole.trim.quantile);
  EXPECT_EQ(found.cut.triangles_before, whole.trim.triangles_before);
  EXPECT_EQ(found.cut.triangles_removed, whole.trim.triangles_removed);
  EXPECT_EQ(found.cut.triangles_split, whole.trim.triangles_split);
  EXPECT_EQ(found.cut.islands_removed, whole.trim.islands_removed);
  EXPECT_EQ(found.cut.holes_filled, whole.trim.holes_filled);
}

/// The cloud on a disk, in the order of its keys.
class OnDisk {
 public:
  OnDisk(const Cloud& cloud, const Options& options) : options_(options) {
    const std::string path = folder_.file("cloud.ply");
    write_cloud(path, cloud);
    parts_ = io::CloudParts::open(ex_, path);
    parts_->choose_origin(ex_, std::nullopt);
    parts_->leave_out_zero_normals();
    const scale::CloudExtent extent = scale::find_extent(ex_, *parts_, options.keep_strays);
    frame_ = octree::frame_around(extent.strays.core, options.scale);
    sorted_ = std::make_unique<scale::SortedCloud>(ex_, *parts_, setup({}));
  }

  Found in_blocks(int coarse_level, int blocks, const Device& device, scale::BlockReport& report) {
    return in_blocks(ex_, *sorted_, block_options(coarse_level, blocks, {}), device, report);
  }

  /// By several ranks, each of which sorts a part of the cloud and has some of the blocks.
  /// @param report  of one of them
  Found in_blocks_of_ranks(int ranks, int coarse_level, int blocks, const Device& device, scale::BlockReport& report) {
    Found found;
    run_as_ranks(ranks, [&](Ranks& all) {
      const scale::Team team(&all);
      exec::Cpu ex(1);
      const scale::SortedCloud sorted(ex, *parts_, setup(team));
      scale::BlockReport own;
      Found of_rank = in_blocks(ex, sorted, block_options(coarse_level, blocks, team), device, own);
      if (all.rank() != all.size() - 1) return;
      found = std::move(of_rank);
      report = std::move(own);
    });
    return found;
  }

 private:
  [[nodiscard]] std::string folder() const { return std::filesystem::path(folder_.file("any")).parent_path().string(); }

  [[nodiscard]] scale::SortedCloud::Setup setup(const scale::Team& team) const {
    const auto kept = options_.attributes ? scale::KeptAttributes::all : scale::KeptAttributes::none;
    return {folder(), 1 << 20, frame_, {}, false, kept, team};
  }

  Found in_blocks(exec::Cpu& ex, const scale::SortedCloud& sorted, const scale::BlockOptions& options,
                  const Device& device, scale::BlockReport& report) const {
    std::optional<exec::AnySpace> gpu;
    if (device.kind != DeviceKind::cpu) gpu.emplace(device);
    const scale::BlockMeshes meshes = gpu ? scale::reconstruct_blocks(*gpu, ex, sorted, options, report)
                                          : scale::reconstruct_blocks(ex, sorted, options, report);
    Found found;
    const auto read = [&](std::size_t column, auto& values) {
      values.resize(static_cast<std::size_t>(meshes.vertices()));
      meshes.read_column(column, 0, meshes.vertices(), reinterpret_cast<std::byte*>(values.data()));
    };
    read(0, found.vertices);
    for (Vec3f& vertex : found.vertices) vertex = frame_.to_world(vertex);
    read(1, found.normals);
    std::size_t column = 2;
    if (options.density_face > 0) read(column++, found.density);
    for (const scale::PointAttribute& attribute : sorted.attributes())
      visit_type(attribute.type, [&](auto tag) {
        std::vector<decltype(tag)> values;
        read(column++, values);
        found.attributes.push_back({attribute.name, std::move(values)});
      });
    found.triangles.resize(static_cast<std::size_t>(meshes.triangles()));
    meshes.read_triangles(0, meshes.triangles(),
                          reinterpret_cast<scale::BlockMeshes::Indices*>(found.triangles.data()));
    return found;
  }

  [[nodiscard]] scale::BlockOptions block_options(int coarse_level, int blocks, const scale::Team& team) const {
    scale::BlockOptions options = scale::block_options_of(options_, frame_);
    options.folder = folder();
    options.part_samples = 7001;
    options.coarse_level = coarse_level;
    options.blocks = blocks;
    options.team = team;
    return options;
  }

  Options options_;
  TemporaryFolder folder_;
  exec::Cpu ex_{2};
  std::unique_ptr<io::CloudParts> parts_;
  octree::Frame frame_;
  std::unique_ptr<scale::SortedCloud> sorted_;
};

}  // namespace

BlocksCompared compare_blocks(std::uint64_t seed, int divisions, const Device& device) {
  Random random(seed);
  BlocksCompared compared;
  Cloud cloud = choose_cloud(random, compared.cloud);
  const Options options = choose_options(random, compared.options);
  SCOPED_TRACE("seed " + std::to_string(seed) + ": " + compared.cloud + "; " + compared.options);
  cloud = without(cloud, [&](std::size_t i) { return cloud.normals[i] == Vec3f{}; });
  cloud.origin = {};
  if (options.attributes) add_attributes(random, cloud);
  Reconstructor reconstructor(Device::cpu(2));
  Found whole;
  try {
    Mesh mesh = reconstructor.reconstruct(cloud, options);
    whole = {
        std::move(mesh.vertices), std::move(mesh.normals), {}, std::move(mesh.attributes), std::move(mesh.triangles)};
    if (options.density) {
      whole.density = whole.attributes.back().values.as<float>();
      whole.attributes.pop_back();
    }
  } catch (const Error& error) {  // a trim, or pieces, may leave nothing
    if (error.code() != ErrorCode::empty_result) throw;
    return compared;
  }
  OnDisk blocks(cloud, options);
  for (; compared.divisions < divisions; ++compared.divisions) {
    const int counts[] = {1, 2, 3, 4, 7};
    const int count = counts[random.below(5)], above = 2 + random.below(4);
    const int level = std::max(5, options.depth - above);
    const int ranks = compared.divisions % 2 == 0 ? 1 : static_cast<int>(2 + random.below(3));
    SCOPED_TRACE(std::to_string(count) + " blocks, K " + std::to_string(level) + ", ranks " + std::to_string(ranks));
    scale::BlockReport report;
    expect_same(ranks == 1 ? blocks.in_blocks(level, count, device, report)
                           : blocks.in_blocks_of_ranks(ranks, level, count, device, report),
                whole);
    expect_same(report, reconstructor.report());
  }
  compared.is_cut = reconstructor.report().trim.triangles_split > 0;
  return compared;
}

}  // namespace pointskin::test
