// One row of a table, seen where it has to show: on the command line, in --help, in reports and in their schemas.
#include "option_table.hpp"

#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "fluid_args.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

enum class Taste { sweet, sour };

struct ToyArgs {
  int size = 3;
  Taste taste = Taste::sweet;
  bool lid = true;
  std::string label;
  GivenOptions given;
};

ToyArgs seen;  ///< by the last run

OptionTable toy_options(ToyArgs& args) {
  return {{"Toys",
           {option("--size,--bulk N", "of the toy, cells, 1 to 9", &args.size, {"size", 2, kFromOne}),
            option("--taste T", "sweet, sour or acid: the same",
                   one_of<Taste>(args.taste, {{"sweet", Taste::sweet}, {"sour", Taste::sour}, {"acid", Taste::sour}}),
                   {"taste", 1}),
            option("--no-lid", "leave it open", negated(args.lid), {"lid"}),
            option("--label TEXT", "what stands on it", &args.label, {"label"}, {.excludes = "--no-lid"})}}};
}

int run_toy(const ToyArgs& args) {
  seen = args;
  return 0;
}

struct Outcome {
  int exit_code;
  std::string out, err;
};

Outcome run(const Words& args) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int exit_code = run_command_line({make_command({"toy", "Toys with it."}, toy_options, run_toy)}, args);
  return {exit_code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

TEST(OptionTable, SetsWhatItsRowsName) {
  EXPECT_EQ(run({"toy", "--bulk", "7", "--taste=acid", "--no-lid"}).exit_code, 0);
  EXPECT_EQ(seen.size, 7);
  EXPECT_EQ(seen.taste, Taste::sour);
  EXPECT_FALSE(seen.lid);
  EXPECT_TRUE(seen.given.has("--size") && seen.given.has("--taste") && !seen.given.has("--label"));
}

TEST(OptionTable, LeavesDefaultsAlone) {
  EXPECT_EQ(run({"toy"}).exit_code, 0);
  EXPECT_EQ(seen.size, 3);
  EXPECT_EQ(seen.taste, Taste::sweet);
  EXPECT_TRUE(seen.lid);
}

TEST(OptionTable, IsWhatHelpLists) {
  const std::string help = run({"toy", "--help"}).out;
  EXPECT_NE(help.find("\nToys:\n  --size, --bulk N          of the toy, cells, 1 to 9 [default 3]\n"),
            std::string::npos)
      << help;
  EXPECT_NE(help.find("  --taste T                 sweet, sour or acid: the same [default sweet]\n"),
            std::string::npos);
  EXPECT_NE(help.find("  --no-lid                  leave it open\n"), std::string::npos);
}

TEST(OptionTable, NamesTheOptionOfAWordThatItDoesNotKnow) {
  const Outcome outcome = run({"toy", "--taste", "salty"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--taste: 'salty' is not sweet, sour or acid;"), std::string::npos) << outcome.err;
}

TEST(OptionTable, RefusesOptionsThatExcludeEachOther) {
  EXPECT_EQ(run({"toy", "--no-lid", "--label", "x"}).exit_code, 2);
}

TEST(OptionTable, IsWhatReportsShowInTheOrderOfThePlaces) {
  ToyArgs args;
  args.size = 5;
  args.taste = Taste::sour;
  EXPECT_EQ(report_of(toy_options, args).dump(), R"({"taste":"sour","size":5,"lid":true,"label":null})");
}

TEST(OptionTable, IsWhatTheSchemaSays) {
  ToyArgs args;
  EXPECT_EQ(Json::parse(schema_of(toy_options(args)).dump()), Json::parse(R"({
    "type": "object", "additionalProperties": false, "required": ["taste", "size", "lid", "label"], "properties": {
      "taste": {"enum": ["sweet", "sour"]}, "size": {"type": "integer", "minimum": 1},
      "lid": {"type": "boolean"}, "label": {"type": ["string", "null"]}}})"));
}

TEST(OptionTable, MakesAnObjectOfAGroup) {
  ToyArgs args;
  OptionTable table = toy_options(args);
  table[0].object = "toy";
  table.push_back({"More", {option("--more", "of it", &args.lid, {"more", 1})}});
  EXPECT_EQ(report_of(table).dump(), R"({"toy":{"taste":"sweet","size":3,"lid":true,"label":null},"more":true})");
}

/// The schema of the options in a file of docs/.
Json committed(const std::string& schema) {
  std::ifstream file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/" + schema + ".schema.json");
  Json options = Json::parse(file).at("properties").at("options");
  options.erase("description");
  return options;
}

Json schema_of_command(const std::string& name) {
  for (const Command& command : all_commands())
    if (command.texts.name == name) return Json::parse(schema_of(command.options).dump());
  return nullptr;
}

void expect_same(const Json& expected, const std::string& schema) {
  EXPECT_TRUE(expected == committed(schema))
      << "docs/" << schema << ".schema.json differs from the table; its properties/options should be\n"
      << expected.dump(2) << "\n"
      << Json::diff(committed(schema), expected).dump(1);
}

TEST(OptionTable, IsWhatTheCommittedSchemasSay) {
  for (const char* const name : {"boolean", "deform", "edit", "fluid", "orient", "bench"})
    expect_same(schema_of_command(name), name);
  FluidArgs args;
  expect_same(Json::parse(schema_of(simulation_report_options(args)).dump()), "simulation");
}

/// One schema for both commands: what only problems has may be absent.
TEST(OptionTable, IsWhatTheCommittedSchemaOfReconstructionsSays) {
  Json expected = schema_of_command("problems");
  expected["required"] = schema_of_command("reconstruct").at("required");
  expect_same(expected, "report");
}

}  // namespace
}  // namespace pointskin::cli
