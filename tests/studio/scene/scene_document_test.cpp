// Documents: what is written is read again to the last bit, what is wrong is named, and the schemas tell the truth.
#include <cmath>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "cli/schema.hpp"
#include "scene/options.hpp"
#include "studio/scene/scene_support.hpp"

namespace pointskin::test {
namespace {

using scene::Document;

nlohmann::json schema(const std::string& name) {
  return nlohmann::json::parse(std::ifstream(std::string(POINTSKIN_SOURCE_DIR) + "/docs/" + name + ".schema.json"));
}

Document parsed(const std::string& text) { return scene::parse_document(text, "doc", "/folder"); }

std::string with(const std::string& operation) { return R"({"version": 1, "operations": [)" + operation + "]}"; }

/// What is said of a document that is wrong.
std::string refusal(const std::string& text) {
  try {
    (void)parsed(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_input);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "nothing";
}

TEST(SceneDocument, EveryOperationIsTheSameAfterItWasWritten) {
  std::vector<std::string> texts = one_of_every_kind();
  texts.insert(texts.end(),
               {R"({"op": "orient", "method": "estimate", "sensors": [[1, 2, 3.3]], "max_rounds": 7, "seed": 9,
                    "random_start": true, "curvature": true})",
                R"({"op": "orient", "method": "iterate"})", R"({"op": "orient", "method": "sensor"})",
                R"({"op": "boolean", "operation": "symmetric", "with": {"shape": "torus"}, "creases": "none"})",
                R"({"op": "boolean", "operation": "intersection", "with": {"shape": "torus"}, "rotation":
                    {"axis": [0.3, 1, 2], "degrees": 77.7}})",
                R"({"op": "insert", "shape": "sphere", "points": 50, "camera": {"view": [1,0,0,0, 0,1,0,0, 0,0,1,0,
                    0,0,0,1], "projection": [0.5,0,0,0, 0,0.5,0,0, 0,0,1,0, 0,0,0,1], "width": 400, "height": 300},
                    "rectangle": [0, 0, 200, 300]})",
                R"({"op": "deform", "handles": [{"region": {"points": [1, 5]}, "affine": {"matrix":
                    [[1, 0.1, 0, 2], [0, 1.3, 0, 0], [0, 0, 0.7, 0]], "pivot": [1, 0, 0]}},
                    {"region": {"capsule": {"from": [0, 0, 0], "to": [0, 0.1, 0], "radius": 0.3}},
                     "rigid": {"radians": 0.7}}, {"region": {"box": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}}],
                    "lattices": [{"origin": [0, 0, 0], "axes": [[1, 0, 0.1], [0, 1, 0], [0, 0, 1]],
                    "spans": [1, 1, 1], "outside": "stay"}]})"});
  std::set<std::string> kinds;
  for (const std::string& text : texts) {
    const nlohmann::ordered_json once = scene::to_json(operation_from(text), "");
    const nlohmann::ordered_json twice = scene::to_json(operation_from(once.dump()), "");
    EXPECT_EQ(once.dump(), twice.dump()) << text;
    kinds.insert(once["op"]);
  }
  EXPECT_EQ(kinds.size(), 8U);
}

TEST(SceneDocument, AnglesComeBackToTheLastBit) {
  for (int i = 0; i < 1000; ++i) {
    scene::Deform deform;
    RigidMotion motion;
    motion.angle = std::sin(i * 1.7) * 3;
    deform.deformation.handles.push_back({Ball{}, motion});
    const auto back = std::get<scene::Deform>(operation_from(scene::to_json(deform, "").dump()));
    EXPECT_EQ(std::get<RigidMotion>(back.deformation.handles[0].transform).angle, motion.angle);
  }
}

TEST(SceneDocument, FilesAreSeenFromItsFolder) {
  const Document document = parsed(R"({"version": 1, "clouds": [{"file": "a.ply"}, {"shape": "hand"}], "operations": [
      {"op": "insert", "file": "../b.ply"}, {"op": "boolean", "operation": "union", "with": {"file": "c/d.stl"}}]})");
  EXPECT_EQ(document.base.clouds[0].file, "/folder/a.ply");
  EXPECT_EQ(document.base.clouds[1].shape, "hand");
  EXPECT_EQ(scene::files_of(document.operations[0], "/"), std::vector<std::string>{"/b.ply"});
  EXPECT_EQ(scene::files_of(document.operations[1], "/"), std::vector<std::string>{"/folder/c/d.stl"});
  const nlohmann::ordered_json moved = to_json(document, "/folder/c");
  EXPECT_EQ(moved["clouds"][0]["file"], "../a.ply");
  EXPECT_EQ(moved["operations"][1]["with"]["file"], "d.stl");
}

TEST(SceneDocument, FilesWithNamesTooLongToBeFoundStayAsTheyAre) {
  const std::string name(5000, 'x');
  const Document document = scene::parse_document(
      R"({"version": 1, "operations": [{"op": "insert", "file": ")" + name + R"("}]})", "edits.json", "/tmp/scene");
  EXPECT_EQ(to_json(document, "/tmp/scene")["operations"][0]["file"], "/tmp/scene/" + name);
}

TEST(SceneDocument, SaysWhatIsWrongAndWhere) {
  const std::vector<std::pair<std::string, std::string>> trials = {
      {"[", "doc: is not JSON"},
      {R"({"version": 2, "operations": []})", "doc.version: must be a whole number in 1..1"},
      {R"({"version": 1})", "doc: needs the key 'operations'"},
      {R"({"version": 1, "operations": [], "cloud": []})", "doc: does not know the key 'cloud'"},
      {R"({"version": 1, "operations": [], "clouds": [{}]})", "doc.clouds[0]: needs one of the keys"},
      {R"({"version": 1, "operations": [], "clouds": [{"shape": "cube"}]})", "doc.clouds[0].shape: must be one of"},
      {R"({"version": 1, "operations": [], "clouds": [{"file": "a", "sha256": "AB"}]})", "doc.clouds[0].sha256"},
      {R"({"version": 1, "operations": [], "shift": "here"})", "doc.shift: must be auto, none or x,y,z"},
      {R"({"version": 1, "operations": [], "options": {"depht": 3}})", "doc.options: does not know the key 'depht'"},
      {R"({"version": 1, "operations": [], "options": {"depth": 33}})", "doc.options.depth: must be a whole number"},
      {R"({"version": 1, "operations": [], "options": {"scale": 0.5}})", "doc.options: "},
      {R"({"version": 1, "operations": [], "options": {"offset": 1}})", "offset must be 0"},
      {R"({"version": 1, "operations": [], "options": {"trim": -1}})", "trim"},
      {R"({"version": 1, "operations": [], "done": 1})", "doc.done: must be a whole number in 0..0"},
      {R"({"version": 1, "operations": [{"op": "undo"}], "done": 0})", "doc.done: must not be there"},
      {with(R"({"op": "bend"})"), "doc.operations[0].op: must be one of guide"},
      {with(R"({"op": 3})"), "doc.operations[0].op: must be one of guide"},
      {with(R"(["op"])"), "doc.operations[0]: must be an object"},
      {with("3"), "doc.operations[0]: must be an object"},
      {with(R"({"op": "undo", "n": 3})"), "doc.operations[0]: does not know the key 'n'"},
      {with(R"({"op": "flip", "camera": {}, "layers": "back"})"), "operations[0].layers: must be one of"},
      {with(R"({"op": "boolean", "operation": "union"})"), "operations[0]: needs the key 'with'"},
      {with(R"({"op": "boolean", "operation": "union", "with": {"shape": "sphere"}, "scale": 0})"), "must be above 0"},
      {with(R"({"op": "orient", "method": "turn", "seed": 1})"), "does not know the key 'seed'"},
      {with(R"({"op": "orient", "method": "estimate", "time_limit_s": 1})"), "does not know the key 'time_limit_s'"},
      {with(R"({"op": "options"})"), "names no option"},
      {with(R"({"op": "options", "scale": 1e999})"), "number that is too large"},
      {with(R"({"op": "options", "warm_start": true})"), "does not know the key 'warm_start'"},
      {with(R"({"op": "deform", "handles": [{"region": {"cone": 1}}]})"), "operations[0].handles[0].region"},
      {with(R"({"op": "insert", "shape": "sphere", "file": "a"})"), "needs one of the keys 'file' and 'shape'"},
      {with(R"({"op": "insert", "file": ""})"), "must name a file"},
      {with(R"({"op": "insert", "shape": "sphere", "camera": {}})"), "has a camera, but no area"},
  };
  for (const auto& [text, part] : trials)
    EXPECT_NE(refusal(text).find(part), std::string::npos) << text << "\n" << refusal(text);
}

TEST(SceneDocument, PlainScriptsStayValid) {
  const Document document = parsed(with(R"({"op": "guide", "camera": {"azimuth": 3}, "stroke": [[1, 2]]},
                                           {"op": "undo"}, {"op": "redo"})"));
  EXPECT_EQ(document.operations.size(), 3U);
  EXPECT_EQ(document.done, 3U);
  EXPECT_TRUE(document.base.clouds.empty() && document.options_given.empty());
}

TEST(SceneDocument, OptionsHaveTheKeysOfTheReportAndAllOfThemAreTaken) {
  const nlohmann::json reported = schema("edit")["properties"]["options"]["properties"];
  const std::set<std::string> elsewhere = {"warm_start", "device", "threads", "shift", "envelope",
                                           "inputs",     "script", "output",  "cloud", "save"};
  std::set<std::string> expected;
  for (const auto& [key, unused] : reported.items())
    if (!elsewhere.contains(key)) expected.insert(key);
  const std::vector<std::string>& keys = scene::option_keys();
  EXPECT_EQ(std::set<std::string>(keys.begin(), keys.end()), expected);

  const nlohmann::json others = {{"depth", 9},          {"field", "distance"},
                                 {"screening", 1.5},    {"iterations", 3},
                                 {"scale", 1.7},        {"samples_per_node", 2.5},
                                 {"confidence", true},  {"fixed_screening", true},
                                 {"linear_fit", true},  {"density", true},
                                 {"weakness", false},   {"attributes", true},
                                 {"normals", false},    {"open", true},
                                 {"boundary", "free"},  {"offset", 0},
                                 {"trim", 0.05},        {"island_ratio", 0.2},
                                 {"largest", true},     {"min_component", 0.1},
                                 {"keep_strays", true}, {"max_memory_bytes", 1e9}};
  nlohmann::json whole = others;
  whole["max_memory_bytes"] = 1'000'000'000;
  const Options read = scene::read_options({whole, "options"}, {});
  EXPECT_EQ(nlohmann::json(scene::options_json(read)), whole);
  Options copied;
  for (const std::string& key : keys) scene::copy_option(key, read, copied);
  EXPECT_EQ(scene::options_json(copied), scene::options_json(read));
}

TEST(SceneDocument, IsWhatItsSchemaSays) {
  Document document = parsed(R"({"version": 1, "clouds": [{"file": "a.ply"}, {"shape": "hand", "points": 7}],
                                 "operations": []})");
  document.base.clouds[0].sha256 = std::string(64, 'a');
  for (const std::string& text : one_of_every_kind())
    document.operations.push_back(scene::to_json(operation_from(text), ""));
  document.done = 3;
  const nlohmann::json written = nlohmann::json::parse(to_json(document, "/folder").dump());
  const nlohmann::json scene = schema("scene");
  EXPECT_EQ(schema_violations(scene, written, "document"), std::vector<std::string>());
  const nlohmann::json operations = scene["$defs"];
  for (const nlohmann::json& operation : written["operations"]) {
    const std::string op = operation["op"];
    ASSERT_TRUE(operations.contains(op)) << op;
    EXPECT_EQ(schema_violations(operations[op], operation, op), std::vector<std::string>());
    nlohmann::json wrong = operation;
    wrong["unheard_of"] = 1;
    EXPECT_FALSE(schema_violations(operations[op], wrong, op).empty());
  }
}

TEST(Sources, MergesShapesAndFilesAndTellsWhatIsLeftOut) {
  const SceneFolder folder;
  Cloud cloud = small_cloud(500);
  cloud.normals[3] = {};
  cloud.attributes.clear();
  write_cloud(folder / "a.ply", cloud);
  scene::CloudSource shape;
  shape.shape = "sphere";
  shape.points = 300;
  scene::ReadFacts facts;
  const Cloud base =
      scene::load_base({scene::cloud_of_file(folder / "a.ply"), shape}, {}, scene::MissingNormals::refused, facts);
  EXPECT_EQ(base.size(), 799);
  EXPECT_EQ(facts.no_normal, 1);
  EXPECT_EQ(facts.not_finite, 0);
  scene::Sources sources;
  const scene::SolidSource file{folder / "a.ply", "", 0};
  EXPECT_EQ(sources.part(file), sources.part(file));
  const auto before = sources.part(file);
  write_cloud(folder / "a.ply", small_cloud(100));
  EXPECT_NE(sources.part(file), before);
}

TEST(Placement, MovesPointsNormalsAndOriginAsASimilarity) {
  Cloud cloud = sphere_cloud(50, 1);
  cloud.origin = {1000, 0, 0};
  Similarity placement;
  placement.scale = 2;
  placement.rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1};  // x to y
  placement.translation = {0, 0, 5};
  const Cloud moved = std::get<Cloud>(scene::placed(cloud, placement));
  EXPECT_EQ(moved.origin, (Vec3d{0, 2000, 5}));
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(moved.positions[i],
              (Vec3f{-2 * cloud.positions[i].y, 2 * cloud.positions[i].x, 2 * cloud.positions[i].z}));
    EXPECT_EQ(moved.normals[i], (Vec3f{-cloud.normals[i].y, cloud.normals[i].x, cloud.normals[i].z}));
  }
  placement.rotation[0] = 1;
  EXPECT_THROW((void)scene::placed(cloud, placement), Error);
}

}  // namespace
}  // namespace pointskin::test
