// Help, version, usage errors: what the program answers before it opens a file.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

const std::vector<std::string> kCommands = {"reconstruct", "info", "check", "compare", "convert", "render"};

void expect_usage_error(const std::vector<std::string>& args, const std::string& hint) {
  const Result result = pointskin_run(args);
  EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(args) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
  EXPECT_NE(result.err.find(hint), std::string::npos) << result.err;
}

TEST(Program, PrintsItsVersionOnStdout) {
  const Result result = pointskin_run({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.starts_with("pointskin 0.") || result.out.starts_with("pointskin 1.")) << result.out;
  EXPECT_EQ(result.err, "");
}

TEST(Program, ListsEveryCommandAndTheExitCodesInItsHelp) {
  const Result result = pointskin_run({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const std::string& command : kCommands)
    EXPECT_NE(result.out.find("\n  " + command), std::string::npos) << command;
  EXPECT_NE(result.out.find("Exit codes"), std::string::npos);
}

TEST(Program, HelpsOnEveryCommand) {
  for (const std::string& command : kCommands) {
    const Result result = pointskin_run({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_EQ(result.err, "") << command;
    EXPECT_NE(result.out.find("pointskin " + command), std::string::npos) << result.out;
  }
}

TEST(Program, GroupsTheHelpOfReconstructAndShowsUnitsAndDefaults) {
  const std::string help = pointskin_run({"reconstruct", "--help"}).out;
  for (const char* part :
       {"Files:", "Surface:", "Device and limits:", "Messages:", "Names of PoissonRecon:", "world unit", "[default 8]",
        "[default 1.1]", "[default 1.5]", "[default auto]", "e.g. 8G"}) {
    EXPECT_NE(help.find(part), std::string::npos) << part << "\n" << help;
  }
}

TEST(Program, HelpLinesFitATerminalOf120Columns) {
  for (const std::string& command : kCommands) {
    const std::string help = pointskin_run({command, "--help"}).out;
    for (std::size_t start = 0, end = 0; (end = help.find('\n', start)) != std::string::npos; start = end + 1) {
      EXPECT_LE(end - start, 120U) << help.substr(start, end - start);
    }
  }
}

TEST(UsageError, IsOneLineWithAHint) {
  expect_usage_error({}, "try 'pointskin --help'");
  expect_usage_error({"frobnicate"}, "try 'pointskin --help'");
  expect_usage_error({"--frobnicate"}, "try 'pointskin --help'");
  expect_usage_error({"reconstruct"}, "try 'pointskin reconstruct --help'");
  expect_usage_error({"reconstruct", "a.ply"}, "-o");
  expect_usage_error({"reconstruct", "a.ply", "-o"}, "try 'pointskin reconstruct --help'");
  expect_usage_error({"reconstruct", "a.ply", "-o", "b.ply", "--frobnicate"}, "--frobnicate");
  expect_usage_error({"info"}, "try 'pointskin info --help'");
  expect_usage_error({"check"}, "try 'pointskin check --help'");
  expect_usage_error({"compare", "a.ply"}, "try 'pointskin compare --help'");
  expect_usage_error({"convert", "a.ply"}, "try 'pointskin convert --help'");
  expect_usage_error({"render", "a.ply"}, "try 'pointskin render --help'");
}

/// Values outside their range are found before the (missing) input is opened.
TEST(UsageError, NamesTheOptionOutOfRange) {
  const std::vector<std::vector<std::string>> cases = {
      {"--depth", "40"},        {"--depth", "0"},           {"--depth", "-1"},
      {"--depth", "8.5"},       {"--depth", "eight"},       {"--threads", "-1"},
      {"--threads", "1000000"}, {"--screening", "-1"},      {"--screening", "nan"},
      {"--iterations", "0"},    {"--iterations", "100000"}, {"--scale", "0.5"},
      {"--scale", "inf"},       {"--scale", "nan"},         {"--samples-per-node", "-1"},
      {"--max-memory", "lots"}, {"--max-memory", "0"},      {"--max-memory", "8Q"},
      {"--max-memory", "-1G"},  {"--shift", "1,2"},         {"--shift", "1,2,x"},
      {"--shift", "here"},      {"--device", "quantum"},    {"--device", "cuda:x"},
      {"--repeat", "0"},        {"--repeat", "-3"},         {"--width", "0"},
      {"--width", "-1"},        {"--width", "nan"},         {"--confidence=2"},
      {"--report", "-"}};
  for (std::vector<std::string> args : cases) {
    args.insert(args.begin(), {"reconstruct", "missing.ply", "-o", "out.ply"});
    expect_usage_error(args, "try 'pointskin reconstruct --help'");
  }
  expect_usage_error({"reconstruct", "missing.ply", "-o", "out.ply", "--depth", "40"}, "depth");
  expect_usage_error({"compare", "a.ply", "b.ply", "--tau", "0"}, "tau");
  expect_usage_error({"compare", "a.ply", "b.ply", "--samples", "0"}, "samples");
  expect_usage_error({"render", "a.ply", "-o", "b.png", "--size", "0x7"}, "size");
}

TEST(UsageError, RefusesAnUnknownOutputFormatBeforeReading) {
  expect_usage_error({"reconstruct", "missing.ply", "-o", "out.docx"}, "out.docx");
  expect_usage_error({"reconstruct", "missing.ply", "-o", "out"}, "out");
  expect_usage_error({"convert", "missing.ply", "out.docx"}, "out.docx");
  expect_usage_error({"render", "missing.ply", "-o", "out.ply"}, ".png");
}

TEST(UsageError, RefusesContradictions) {
  expect_usage_error({"reconstruct", "a.ply", "-o", "b.ply", "-q", "-v"}, "--quiet");
  expect_usage_error({"reconstruct", "a.ply", "-o", "b.ply", "--report", "b.ply"}, "same file");
  expect_usage_error({"reconstruct", "-", "-", "-o", "b.ply"}, "stdin");
  expect_usage_error({"reconstruct", "a.ply", "-o", "b.ply", "--out", "c.ply"}, "--out");
}

}  // namespace
}  // namespace pointskin::test
