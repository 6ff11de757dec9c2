// pointskin formats: which files can be read and written.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <pointskin/formats.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"

namespace pointskin::cli {
namespace {

struct FormatsArgs {
  bool markdown = false;
};

std::string words_joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

/// "points", "meshes, points" or nothing.
std::string kinds(bool meshes, bool clouds) {
  return meshes && clouds ? "meshes, points" : meshes ? "meshes" : clouds ? "points" : "";
}

std::string library_of(const FormatInfo& format) { return format.library.empty() ? "none" : format.library; }

std::string markdown() {
  std::string text =
      "| format | extensions | read | what is read | written | what is written | library | tested against |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const FormatInfo& f : file_formats())
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", f.name, words_joined(f.extensions),
                        kinds(f.reads_meshes, f.reads_clouds), f.read, kinds(f.writes_meshes, f.writes_clouds),
                        f.written, library_of(f), f.tested_against);
  return text;
}

std::string table() {
  std::vector<std::array<std::string, 4>> rows{{"format", "extensions", "reads", "writes"}};
  for (const FormatInfo& f : file_formats())
    rows.push_back({f.name, words_joined(f.extensions),
                    f.built ? kinds(f.reads_meshes, f.reads_clouds) : "not in this build: needs " + f.library,
                    kinds(f.writes_meshes, f.writes_clouds)});
  std::array<std::size_t, 4> widths{};
  for (const auto& row : rows)
    for (std::size_t c = 0; c < widths.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  std::string text;
  for (const auto& row : rows)
    text +=
        fmt::format("{:<{}}  {:<{}}  {:<{}}  {}\n", row[0], widths[0], row[1], widths[1], row[2], widths[2], row[3]);
  return text;
}

int run_formats(const FormatsArgs& args) {
  write_stdout(args.markdown ? markdown() : table());
  return 0;
}

OptionTable formats_options(FormatsArgs& args) {
  return {{"Output",
           {option("--markdown", "the table of docs/formats.md, with what of each format is kept", &args.markdown)}}};
}

}  // namespace

Command formats_command() {
  return make_command({"formats", "List the file formats that are read and written."}, formats_options, run_formats);
}

}  // namespace pointskin::cli
