#include "file_plan.hpp"

#include <unistd.h>

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "args.hpp"
#include "file_identity.hpp"

namespace pointskin::cli {
namespace {

using Kind = FileIdentity::Kind;

void check_stdin(const std::vector<InputFile>& inputs) {
  const auto is_stdin = [](const InputFile& input) { return input.file == "-"; };
  if (std::count_if(inputs.begin(), inputs.end(), is_stdin) > 1) throw_usage("stdin (-) can be read only once");
}

void check_stdout(const std::vector<OutputFile>& outputs) {
  const char* result = nullptr;
  for (const OutputFile& output : outputs) {
    if (output.file != "-") continue;
    if (output.kind != OutputKind::result)
      throw_usage(fmt::format("{}: stdout carries data only; name a file", output.option));
    if (result != nullptr)
      throw_usage(fmt::format("{}: stdout carries what {} asks for; name a file", output.option, result));
    result = output.option;
  }
}

/// Compares one output after another with what came before.
class PathComparison {
 public:
  explicit PathComparison(const FilePlan& plan) : plan_(plan) {
    for (const InputFile& input : plan.inputs) {
      FileIdentity identity = input.file == "-" ? identify_descriptor(STDIN_FILENO) : identify(input.file);
      if (identity.kind != Kind::missing) inputs_.emplace(std::move(identity), &input);
    }
  }

  void add(const OutputFile& output) {
    FileIdentity identity = output.file == "-" ? identify_descriptor(STDOUT_FILENO) : identify(output.file);
    if (identity.kind == Kind::device) return;
    const auto [first, last] = inputs_.equal_range(identity);
    for (auto at = first; at != last; ++at) compare(output, *at->second, identity.kind);
    const auto [other, is_new] = outputs_.emplace(std::move(identity), &output);
    if (!is_new) refuse_twice(output, *other->second);
  }

 private:
  void compare(const OutputFile& output, const InputFile& input, Kind kind) const {
    const std::string name = input.file == "-" ? "on stdin" : input.file;
    const std::string what = fmt::format("{} would overwrite the input {}", output.option, name);
    if (kind == Kind::pipe && input.file == "-" && output.file == "-") return;  // a socket may carry both ways
    if (kind == Kind::pipe) throw_usage(what + ", a pipe that is read; name another file");
    if (output.file == "-") throw_usage(what + ", to which stdout leads; name another file");
    if (output.kind == OutputKind::report) throw_usage(what + "; name another file");
    if (output.frame != input.frame)
      throw_usage(fmt::format("{} by {}: {}; name other files", what, output.file,
                              input.frame == kNoFrame ? "all frames are made of it" : "another frame is made of it"));
    if (!plan_.overwrite) throw_usage(what + "; --overwrite allows that");
  }

  [[noreturn]] static void refuse_twice(const OutputFile& output, const OutputFile& other) {
    const std::string also = output.file == other.file ? "" : fmt::format(": {} and {}", output.file, other.file);
    if (std::string(output.option) == other.option)
      throw_usage(fmt::format("{} names the same file twice{}", output.option, also));
    throw_usage(fmt::format("{} and {} name the same file{}", output.option, other.option, also));
  }

  const FilePlan& plan_;
  std::multimap<FileIdentity, const InputFile*> inputs_;
  std::map<FileIdentity, const OutputFile*> outputs_;
};

}  // namespace

void FilePlan::add_frame(const std::string& input, const std::string& output, OutputKind kind) {
  const auto frame = static_cast<std::int64_t>(inputs.size());
  inputs.push_back({input, frame});
  outputs.push_back({"-o", output, kind, frame});
}

void check_files(const FilePlan& plan) {
  check_stdin(plan.inputs);
  check_stdout(plan.outputs);
  PathComparison comparison(plan);
  for (const OutputFile& output : plan.outputs)
    if (!output.file.empty()) comparison.add(output);
}

void check_distinct(const std::vector<std::string>& inputs, const std::vector<OutputFile>& outputs, bool overwrite) {
  FilePlan plan{{}, outputs, overwrite};
  for (const std::string& input : inputs)
    if (!input.empty()) plan.inputs.push_back({input});
  check_files(plan);
}

}  // namespace pointskin::cli
