// Where people meet the formats by name, help and documents, they meet all that the table of formats knows.
#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include <pointskin/formats.hpp>

#include "cli/program.hpp"

namespace pointskin::test {
namespace {

/// The help of a command on one line.
std::string help_of(const std::string& command) {
  std::string help = pointskin_run({command, "--help"}).out;
  const auto is_space = [](char a, char b) { return std::isspace(a) != 0 && std::isspace(b) != 0; };
  std::replace(help.begin(), help.end(), '\n', ' ');
  help.erase(std::unique(help.begin(), help.end(), is_space), help.end());
  return help;
}

std::string document(const std::string& name) {
  std::ifstream file(POINTSKIN_SOURCE_DIR "/" + name);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(FormatsInHelp, OutputsNameThoseThatMeshesAreWrittenIn) {
  const std::string list = "mesh: " + extension_list(&FormatInfo::writes_meshes);
  for (const char* command : {"reconstruct", "boolean", "deform", "edit", "fluid"})
    EXPECT_NE(help_of(command).find("-o, --output OUT " + list), std::string::npos) << command;
}

TEST(FormatsInHelp, MeshesNameThoseThatTheyAreReadFrom) {
  const std::string convert = help_of("convert");
  const std::string check = help_of("check");
  for (const FormatInfo& format : file_formats()) {
    if (format.reads_meshes) {
      EXPECT_NE(convert.find(format.name), std::string::npos) << format.name;
      EXPECT_NE(check.find(format.name), std::string::npos) << format.name;
    }
    if (format.writes_meshes || format.writes_clouds) {
      EXPECT_NE(convert.find(format.extensions.front()), std::string::npos) << format.name;
    }
  }
}

TEST(FormatsInHelp, DocumentsNameThemAll) {
  const std::string manual = document("docs/cli.md");
  const std::string header = document("include/pointskin/io.hpp");
  for (const FormatInfo& format : file_formats())
    for (const std::string& extension : format.extensions) {
      std::string name = extension.substr(1);
      for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      EXPECT_NE(manual.find(name), std::string::npos) << name;
      EXPECT_NE(header.find(name), std::string::npos) << name;
    }
}

TEST(FormatsCommand, PrintsTheTableOfTheDocument) {
  const std::string table = pointskin_run({"formats", "--markdown"}).out;
  EXPECT_NE(document("docs/formats.md").find(table), std::string::npos) << table;
}

TEST(FormatsCommand, ListsThemAllOnATerminal) {
  const std::string list = pointskin_run({"formats"}).out;
  for (const FormatInfo& format : file_formats()) EXPECT_NE(list.find("\n" + format.name + " "), std::string::npos);
}

}  // namespace
}  // namespace pointskin::test
