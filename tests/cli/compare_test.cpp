// compare: meshes and clouds, its JSON against its schema, and --heat.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "cli/schema.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;
using Args = std::vector<std::string>;

class CompareCommand : public testing::Test {
 protected:
  CompareCommand() {
    write_mesh(mesh_, icosphere_mesh(4));
    write_cloud(cloud_, sphere_cloud(5000, 1));
  }

  /// What compare prints as JSON, which follows the schema.
  static Json json_of(Args args) {
    args.insert(args.begin(), "compare");
    args.emplace_back("--json");
    const Result result = pointskin_run(args);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    Json json = Json::parse(result.out);
    const Json rules = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/compare.schema.json"));
    for (const std::string& violation : schema_violations(rules, json, "compare")) ADD_FAILURE() << violation;
    return json;
  }

  void expect_failure(Args args, int code, const std::string& part) {
    args.insert(args.begin(), "compare");
    expect_error(pointskin_run(args), code, part);
    EXPECT_FALSE(std::filesystem::exists(heat_));
  }

  static const std::vector<float>& values_of(const std::vector<Attribute>& attributes, const std::string& name) {
    const auto found =
        std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& a) { return a.name == name; });
    if (found == attributes.end()) throw std::runtime_error("no attribute " + name);
    return found->values.as<float>();
  }

  TemporaryFolder folder_;
  std::string mesh_ = folder_ / "mesh.ply";
  std::string cloud_ = folder_ / "cloud.ply";
  std::string heat_ = folder_ / "heat.ply";
};

TEST_F(CompareCommand, SaysWhatItComparesOnEitherSide) {
  const Json mixed = json_of({cloud_, mesh_, "--samples", "3000"});
  EXPECT_EQ(mixed["a"],
            (Json{{"file", cloud_}, {"kind", "cloud"}, {"points", 5000}, {"normals", true}, {"samples", 3000}}));
  EXPECT_EQ(mixed["b"],
            (Json{{"file", mesh_}, {"kind", "mesh"}, {"vertices", 2562}, {"triangles", 5120}, {"samples", 3000}}));
  const Json other_way = json_of({mesh_, cloud_, "--samples", "5000"});
  EXPECT_EQ(other_way["a"]["kind"], "mesh");
  EXPECT_EQ(other_way["b"]["samples"], 5000);
  for (const std::string key : {"mean", "rms", "p95", "max"})  // all 5000 points to the mesh, either way
    EXPECT_EQ(other_way["from_reference"][key], json_of({cloud_, mesh_, "--samples", "5000"})["to_reference"][key]);
}

TEST_F(CompareCommand, MeasuresCloudsAsExpected) {
  // Facets of the sphere sag by less than the square of an edge over 6, and edges are below 0.085.
  const Json to_mesh = json_of({cloud_, mesh_});
  EXPECT_LT(to_mesh["to_reference"]["max"], 1.2e-3);
  EXPECT_GT(to_mesh["normal_consistency"], 0.99);
  // To the nearest of 5000 random points on a sphere: 1 / (2 sqrt(density)) in the mean.
  const double expected = 0.5 / std::sqrt(5000 / (4 * std::acos(-1.0)));
  EXPECT_NEAR(to_mesh["from_reference"]["mean"].get<double>(), expected, 0.05 * expected);
  EXPECT_EQ(json_of({cloud_, cloud_})["two_sided"]["max"], 0);
}

TEST_F(CompareCommand, SaysWhereThereAreNoNormalsToCompare) {
  write_file(folder_ / "bare.ply", ply_bytes(test::sphere(1000), false));
  const Json bare = json_of({mesh_, folder_ / "bare.ply", "--samples", "1000"});
  EXPECT_TRUE(bare["normal_consistency"].is_null());
  EXPECT_EQ(bare["b"]["normals"], false);
  const Result people = pointskin_run({"compare", mesh_, folder_ / "bare.ply", "--samples", "1000"});
  EXPECT_NE(people.out.find("cloud, 1000 points without normals"), std::string::npos) << people.out;
  EXPECT_NE(people.out.find("normal consistency  none"), std::string::npos) << people.out;
  const Result few = pointskin_run({"compare", cloud_, mesh_, "--samples", "100"});
  EXPECT_NE(few.out.find("cloud, 5000 points with normals, 100 of them taken"), std::string::npos) << few.out;
  EXPECT_NE(few.out.find("mesh, 5120 triangles, 100 samples"), std::string::npos) << few.out;
}

TEST_F(CompareCommand, KeepsTheMillimetresOfSurveyCoordinates) {
  // A grid near (1e6, 4e6), once with coordinates in text and once moved by 3 mm, in files with different bounds and so
  // different origins.
  std::string here, there = "999000 3999000 0\n";
  for (int i = 0; i < 400; ++i) {
    const double x = 1e6 + i % 20, y = 4e6 + i / 20;
    char line[128];
    std::snprintf(line, sizeof line, "%.4f %.4f %.4f\n", x, y, 250.0);
    here += line;
    std::snprintf(line, sizeof line, "%.4f %.4f %.4f\n", x, y, 250.003);
    there += line;
  }
  write_file(folder_ / "here.xyz", here);
  write_file(folder_ / "there.xyz", there);
  const Json found = json_of({folder_ / "here.xyz", folder_ / "there.xyz"});
  for (const char* key : {"mean", "rms", "max"})
    EXPECT_NEAR(found["to_reference"][key].get<double>(), 0.003, 2e-4) << key;
}

TEST_F(CompareCommand, WritesTheDistanceOfEveryVertex) {
  const std::string small = folder_ / "small.ply";
  write_mesh(small, box_mesh({-0.25, -0.25, -0.25}, {0.25, 0.25, 0.25}));
  const Json numbers = json_of({mesh_, small, "--heat", heat_, "--samples", "2000"});
  const Mesh mesh = read_mesh(mesh_), heat = read_mesh(heat_);
  EXPECT_EQ(heat.vertices, mesh.vertices);
  EXPECT_EQ(heat.normals, mesh.normals);
  EXPECT_EQ(heat.triangles, mesh.triangles);
  const std::vector<float>& values = values_of(heat.attributes, "distance");
  const std::vector<double> expected = distances(mesh, read_mesh(small));
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], static_cast<float>(expected[i])) << i;
  EXPECT_EQ(numbers["to_reference"], json_of({mesh_, small, "--samples", "2000"})["to_reference"]);  // as without
}

TEST_F(CompareCommand, WritesSignedDistancesOfACloudToAClosedMesh) {
  const std::string points = folder_ / "points.ply";
  Cloud cloud = sphere_cloud(500, 2, 0.5);
  append(cloud, sphere_cloud(500, 3, 2.0));
  cloud.attributes.push_back({"signed_distance", std::vector<float>(1000, 7)});
  cloud.attributes.push_back({"quality", std::vector<float>(1000, 3)});
  write_cloud(points, cloud);
  json_of({points, mesh_, "--heat", heat_, "--signed", "--samples", "2000"});
  const Cloud heat = read_cloud(heat_);
  EXPECT_EQ(heat.positions, cloud.positions);
  EXPECT_EQ(heat.attributes.size(), 2U);  // one of that name is replaced
  EXPECT_EQ(values_of(heat.attributes, "quality")[999], 3);
  const std::vector<float>& values = values_of(heat.attributes, "signed_distance");
  for (std::size_t i = 0; i < 1000; ++i) ASSERT_NEAR(values[i], i < 500 ? -0.5 : 1, 2e-3) << i;
}

TEST_F(CompareCommand, KeepsTheOriginOfWhatItWrites) {
  Mesh far = icosphere_mesh(3);
  far.origin = {1e6, 4e6, 250};
  const std::string there = folder_ / "far.ply", reference = folder_ / "reference.ply";
  write_mesh(there, far);
  far.origin[2] += 5;
  write_mesh(reference, far);
  json_of({there, reference, "--heat", heat_, "--samples", "2000"});
  const Mesh heat = read_mesh(heat_), mesh = read_mesh(there);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    ASSERT_NEAR(heat.origin[2] + heat.vertices[i].z, mesh.origin[2] + mesh.vertices[i].z, 1e-6);
  const std::vector<float>& values = values_of(heat.attributes, "distance");
  EXPECT_NEAR(*std::min_element(values.begin(), values.end()), 3, 0.01);  // spheres of radius 1, 5 apart
}

TEST_F(CompareCommand, RefusesWhatCannotBeWritten) {
  expect_failure({mesh_, cloud_, "--heat", folder_ / "heat.obj"}, 2, ".ply");
  expect_failure({mesh_, cloud_, "--heat", "-"}, 2, "--heat");
  expect_failure({mesh_, cloud_, "--heat", mesh_}, 2, "overwrite");
  expect_failure({mesh_, cloud_, "--heat", folder_ / "none/heat.ply"}, 8, "none");
  expect_failure({mesh_, mesh_, "--signed"}, 2, "--signed");
  expect_failure({mesh_, cloud_, "--heat", heat_, "--signed"}, 3, "cloud");
  write_mesh(folder_ / "open.ply", patch_mesh(3));
  expect_failure({mesh_, folder_ / "open.ply", "--heat", heat_, "--signed"}, 3, "watertight");
  expect_failure({mesh_, folder_ / "missing.ply", "--heat", heat_}, 3, "missing.ply");
}

TEST_F(CompareCommand, RefusesWhatItCannotCompare) {
  expect_failure({"-", "-"}, 2, "stdin");
  expect_failure({mesh_, cloud_, "--samples", "0"}, 2, "--samples");
  expect_failure({mesh_, cloud_, "--tau", "0"}, 2, "--tau");
  write_file(folder_ / "empty.ply", ply_bytes({}));
  expect_failure({mesh_, folder_ / "empty.ply"}, 3, "empty.ply");
}

TEST_F(CompareCommand, ReadsEitherSideFromStdin) {
  Start start;
  start.input = read_file(cloud_);
  for (const Args& args : {Args{"compare", "-", mesh_, "--json"}, Args{"compare", mesh_, "-", "--json"}}) {
    start.args = args;
    const Result result = run_program(start);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(Json::parse(result.out)[args[1] == "-" ? "a" : "b"]["kind"], "cloud");
  }
}

TEST_F(CompareCommand, GivesTheSameBytesForAnyNumberOfThreads) {
  const auto run = [&](const char* threads) {
    const Result result =
        pointskin_run({"compare", cloud_, mesh_, "--json", "--heat", heat_, "--samples", "5000", "--threads", threads});
    return result.out + read_file(heat_);
  };
  EXPECT_EQ(run("1"), run("3"));
}

}  // namespace
}  // namespace pointskin::test
