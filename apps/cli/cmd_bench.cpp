// pointskin bench: times and memory on this machine, beside another program where one is given.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "bench/bench_args.hpp"
#include "bench/clouds.hpp"
#include "bench/launcher.hpp"
#include "bench/measure.hpp"
#include "bench/plot.hpp"
#include "bench/results_json.hpp"
#include "bench/table.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "progress.hpp"
#include "signals.hpp"
#include "summary_words.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

/// A folder for the files of the programs, removed at the end.
class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "pointskin-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw Error(ErrorCode::output_not_written, fmt::format("{}: cannot make this folder", name));
    }
    path_ = name;
  }
  ~WorkFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Shows what is being measured. A depth costs about four times the one before.
class BenchProgress {
 public:
  BenchProgress(const std::vector<CloudSource>& sources, bool shown) : line_(shown) {
    for (const CloudSource& source : sources) {
      for (const int depth : source.depths) all_ += std::pow(4.0, depth);
    }
  }
  void begin(const std::string& cloud, int depth) { what_ = fmt::format("{}, depth {}", one_line(cloud), depth); }
  void end(int depth) { done_ += std::pow(4.0, depth); }
  void show() { line_.update({what_.c_str(), done_ / all_}); }
  /// Before lines on stdout, which may be the same terminal.
  void clear() { line_.clear(); }

 private:
  ProgressLine line_;
  std::string what_;
  double all_ = 0, done_ = 0;
};

/// What is set up before the first cloud and used until the last.
struct Bench {
  const BenchArgs& args;
  std::vector<Device> devices{};
  std::vector<Reconstructor> reconstructors{};  ///< one a device
  std::vector<std::string> peer{};              ///< words; empty: none
  std::optional<WorkFolder> folder{};           ///< with a peer; goes after the launcher, whose programs write there
  std::optional<Launcher> launcher{};           ///< with a peer
  std::size_t name_width = 5;                   ///< of the column of clouds
  Results results{};
};

/// The other program and the files that its command names are read, too.
void check_outputs(const BenchArgs& args, const std::vector<std::string>& peer) {
  std::vector<std::string> inputs = args.inputs;
  for (const std::string& word : peer) {
    if (word != "-") inputs.push_back(word);
    if (word.find('=') != std::string::npos) inputs.push_back(word.substr(word.find('=') + 1));  // --config=FILE
  }
  check_distinct(inputs, {{"--report", args.report, OutputKind::report}, {"--plot", args.plot, OutputKind::report}});
  for (const std::string& file : {args.report, args.plot})
    if (!file.empty()) check_replaceable(file);
}

void measure_depth(Bench& bench, const Cloud& cloud, int depth, BenchProgress& progress) {
  const auto keep_going = [&progress] {
    progress.show();
    return !interrupted();
  };
  for (Reconstructor& reconstructor : bench.reconstructors) {
    MemoryRun run = measure_in_memory(reconstructor, cloud, {depth, bench.args.repeat, keep_going});
    run.cloud = bench.results.clouds.size() - 1;
    bench.results.memory_runs.push_back(std::move(run));
    progress.clear();
    write_stdout(memory_row(bench.results, bench.results.memory_runs.back(), bench.name_width));
  }
}

void race_depth(Bench& bench, const std::string& input, int depth) {
  const Race race = {input,     bench.folder->path(), depth, bench.args.threads, bench.args.peer_repeat, bench.devices,
                     bench.peer};
  for (FileRun& run : measure_files(*bench.launcher, race)) {
    run.cloud = bench.results.clouds.size() - 1;
    if (!run.failure.empty()) {
      const std::string& cloud = bench.results.clouds.back().name;
      print_warning(fmt::format("{}, depth {}: {} failed: {}", cloud, depth, run.program, run.failure));
    }
    bench.results.file_runs.push_back(std::move(run));
  }
}

/// Once a cloud is there: of a run that cannot begin, the error is the only line.
void begin_table(const Bench& bench) {
  for (const Device& device : bench.devices) {
    if (!bench.args.quiet) print_note(fmt::format("{}: {}", short_name(device), device.name()));
  }
  write_stdout(memory_header(bench.name_width));
}

void measure_cloud(Bench& bench, const CloudSource& source, BenchProgress& progress) {
  const Cloud cloud = load(source, bench.args.threads);
  if (bench.results.clouds.empty()) begin_table(bench);
  bench.results.clouds.push_back({source.name, source.path, source.shape, cloud.size(), cloud.dropped});
  std::string input = source.path.empty() ? "" : std::filesystem::absolute(source.path).string();
  if (bench.launcher && input.empty()) {
    input = bench.folder->path() + "/cloud.ply";
    write_cloud(input, cloud, bench.args.threads);
  }
  for (const int depth : source.depths) {
    progress.begin(source.name, depth);
    measure_depth(bench, cloud, depth, progress);
    if (bench.launcher) race_depth(bench, input, depth);
    throw_if_interrupted();
    progress.end(depth);
  }
}

void write_outputs(const Bench& bench) {
  const BenchArgs& args = bench.args;
  if (!args.report.empty()) {
    write_file_atomically(args.report, json_text(to_json(bench.results, args, bench.devices)));
    file_was_written();
  }
  if (!args.plot.empty()) {
    write_file_atomically(args.plot, plot(bench.results));
    file_was_written();
  }
  for (const std::string& file : {args.report, args.plot})
    if (!file.empty() && !args.quiet) print_note(file_words(file) + "written");
}

/// Whatever can be refused is refused here, before the first measurement.
void prepare(Bench& bench, const std::vector<CloudSource>& sources) {
  const BenchArgs& args = bench.args;
  if (!args.peer.empty()) bench.peer = parse_peer(args.peer);
  check_outputs(args, bench.peer);
  if (!bench.peer.empty()) {
    bench.launcher.emplace();
    bench.folder.emplace();
  }
  bench.devices = parse_devices(args.devices, args.threads);
  for (const Device& device : bench.devices) bench.reconstructors.emplace_back(device);
  for (const CloudSource& source : sources) bench.name_width = std::max(bench.name_width, source.name.size());
}

int run(const BenchArgs& args) {
  on_interrupt(OnInterrupt::remember);
  const std::vector<CloudSource> sources = cloud_sources(args);
  Bench bench{.args = args};
  prepare(bench, sources);
  if (args.peer.empty()) warn_unused(args.given, {"--peer-repeat"}, "without --peer");
  BenchProgress progress(sources, !args.quiet && stderr_is_terminal());
  for (const CloudSource& source : sources) measure_cloud(bench, source, progress);
  if (bench.launcher) write_stdout(file_table(bench.results, bench.name_width));
  write_outputs(bench);
  const std::vector<FileRun>& runs = bench.results.file_runs;
  const bool any_failed = std::any_of(runs.begin(), runs.end(), [](const FileRun& r) { return !r.failure.empty(); });
  return any_failed ? static_cast<int>(ErrorCode::empty_result) : 0;
}

}  // namespace

Command bench_command() {
  return make_command({"bench", "Measure times and memory, also of another program."}, bench_options, run);
}

}  // namespace pointskin::cli
