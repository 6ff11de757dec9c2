#include "reconstruct_each.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>

#include "args.hpp"
#include "at_once.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "input.hpp"
#include "output_check.hpp"
#include "progress.hpp"
#include "reconstruct_run.hpp"
#include "report.hpp"
#include "scene/frame_files.hpp"
#include "signals.hpp"
#include "statistics.hpp"
#include "stopwatch.hpp"

namespace pointskin::cli {
namespace {

/// One of the clouds and what became of it.
struct OneOfMany {
  std::string input, output, report;
  std::uintmax_t bytes = 0;  ///< of the input's file
  std::optional<Error> error;
  std::int64_t points = 0, triangles = 0;
  std::int64_t needs = 0;  ///< bytes that the run took
  double ms = 0;
};

std::vector<OneOfMany> clouds_of(const ReconstructArgs& args) {
  std::vector<OneOfMany> clouds;
  for (const std::string& input : args.inputs) {
    const std::string name = std::filesystem::path(input).stem().string();
    OneOfMany& cloud = clouds.emplace_back();
    cloud.input = input;
    cloud.output = scene::with_number(args.output, name);
    if (!args.report.empty()) cloud.report = scene::with_number(args.report, name);
    std::error_code missing;  // the reader tells
    const std::uintmax_t bytes = std::filesystem::file_size(input, missing);
    if (!missing) cloud.bytes = bytes;
  }
  return clouds;
}

void refuse_with_each(bool given, const char* option) {
  if (given) throw_usage(fmt::format("--each and {} exclude each other", option));
}

void needs_name(const std::string& output, const char* option) {
  if (!scene::is_pattern(output))
    throw_usage(fmt::format("{}: {} needs {{}}, where the input's name goes, because of --each", option, output));
  if (scene::is_pattern(scene::with_number(output, "")))
    throw_usage(fmt::format("{}: {} has {{}} twice", option, output));
}

/// Inputs in different folders may have the same name.
void check_distinct_names(const std::vector<OneOfMany>& clouds) {
  std::map<std::string, const OneOfMany*> by_output;
  for (const OneOfMany& cloud : clouds) {
    const auto [other, is_new] = by_output.emplace(cloud.output, &cloud);
    if (!is_new)
      throw_usage(
          fmt::format("-o: {} would be the mesh of both {} and {}", cloud.output, other->second->input, cloud.input));
  }
}

/// The arguments of a run of its own.
ReconstructArgs args_of(const ReconstructArgs& all, const OneOfMany& cloud, const Device& device) {
  ReconstructArgs args = all;
  args.inputs = {cloud.input};
  args.output = cloud.output;
  args.report = cloud.report;
  args.asked = all;
  args.device = device.text();
  if (device.kind == DeviceKind::cpu) args.threads = device.threads;
  args.quiet = true;
  return args;
}

/// Runs one cloud after another, with memory that is used again. One a thread.
class EachWorker {
 public:
  EachWorker(const ReconstructArgs& args, const Device& device) : args_(args), device_(device) {}

  /// @throws Error interrupted; any other stays with the cloud
  void run(OneOfMany& cloud) {
    throw_if_interrupted();
    const Stopwatch watch;
    const WarningsOf warnings(cloud.input);
    try {
      const Record record = run_reconstruction(args_of(args_, cloud, device_), watch, reconstructor_);
      cloud.points = record.run.points;
      cloud.triangles = record.mesh.triangles;
      cloud.needs = record.run.device_peak_bytes + 64 * (record.points + cloud.triangles) + (std::int64_t{1} << 20);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::interrupted) throw;
      cloud.error = error;
    } catch (const std::bad_alloc&) {
      cloud.error = Error(ErrorCode::over_limit, "the system has no memory left");
    } catch (const std::filesystem::filesystem_error& error) {
      cloud.error = Error(ErrorCode::invalid_input, "cannot be found, " + error.code().message());
    } catch (const std::system_error& error) {
      cloud.error = Error(ErrorCode::over_limit, "the system refuses, " + error.code().message());
    }
    if (cloud.error) cloud.needs = 20 * static_cast<std::int64_t>(cloud.bytes);
    cloud.ms = watch.ms();
  }

 private:
  const ReconstructArgs& args_;
  Device device_;
  std::unique_ptr<Reconstructor> reconstructor_;
};

/// What is said of a cloud: its name once.
std::string story_of(const OneOfMany& cloud) {
  const std::string story = cloud.error->what();
  return story.starts_with(cloud.input + ":") ? story : cloud.input + ": " + story;
}

/// All clouds, the largest files first: the first alone, which tells how many fit into memory at once.
class Batch {
 public:
  Batch(const ReconstructArgs& args, const Device& device, std::vector<OneOfMany>& clouds)
      : args_(args), device_(device), line_(!args.quiet && stderr_is_terminal()) {
    for (OneOfMany& cloud : clouds) order_.push_back(&cloud);
    std::stable_sort(order_.begin(), order_.end(),
                     [](const OneOfMany* a, const OneOfMany* b) { return a->bytes > b->bytes; });
  }

  void run();

  [[nodiscard]] int at_once() const { return at_once_; }

 private:
  auto worker(const Device& device) {
    return [this, device] {
      return [this, worker = std::make_unique<EachWorker>(args_, device)](std::size_t i) {
        worker->run(*order_[i]);
        done(*order_[i]);
      };
    };
  }

  void done(const OneOfMany& cloud) {
    const std::lock_guard lock(mutex_);
    if (cloud.error) line_.clear();
    if (cloud.error) print_note("pointskin: warning: " + one_line(story_of(cloud)));
    ++done_;
    line_.update({"clouds", static_cast<double>(done_) / static_cast<double>(order_.size())});
  }

  /// A GPU works on one after the other.
  [[nodiscard]] int clouds_at_once() const {
    const auto left = static_cast<std::int64_t>(order_.size()) - 1;
    if (device_.kind == DeviceKind::cuda || left < 2) return 1;
    const std::int64_t memory = device_.available_bytes() / 5 * 4;
    const std::int64_t fits = memory / std::max<std::int64_t>(order_.front()->needs, std::int64_t{1} << 20);
    return static_cast<int>(std::clamp<std::int64_t>(std::min(fits, left), 1, thread_count(args_.threads)));
  }

  const ReconstructArgs& args_;
  Device device_;
  std::vector<OneOfMany*> order_;
  ProgressLine line_;
  std::mutex mutex_;  // guards done_ and line_
  std::size_t done_ = 0;
  int at_once_ = 1;
};

void Batch::run() {
  run_at_once(0, 1, 1, worker(device_));
  at_once_ = clouds_at_once();
  const bool on_cpu = device_.kind == DeviceKind::cpu;
  run_at_once(1, order_.size(), at_once_,
              worker(on_cpu ? Device::cpu(std::max(1, thread_count(args_.threads) / at_once_)) : device_));
  line_.clear();
}

/// @throws Error if a cloud failed
void throw_if_failed(const std::vector<OneOfMany>& clouds) {
  const auto failed = [](const OneOfMany& cloud) { return cloud.error.has_value(); };
  const auto first = std::find_if(clouds.begin(), clouds.end(), failed);
  if (first == clouds.end()) return;
  throw Error(first->error->code(),
              fmt::format("{} of {} clouds failed; the first: {}", std::count_if(clouds.begin(), clouds.end(), failed),
                          clouds.size(), story_of(*first)));
}

}  // namespace

void check_each(const ReconstructArgs& args) {
  if (args.inputs.empty()) throw_usage("no input; name one or more clouds");
  refuse_with_each(args.dry_run, "--dry-run");
  refuse_with_each(args.given.has("--repeat"), "--repeat");
  refuse_with_each(args.verbose, "--verbose");
  refuse_with_each(args.split, "--split");
  refuse_with_each(args.options.max_memory_bytes > 0, "--max-memory");
  if (args.output.empty()) throw_usage("no output; name it with -o, {} where the input's name goes");
  needs_name(args.output, "-o");
  if (!args.report.empty()) needs_name(args.report, "--report");
  const std::vector<OneOfMany> clouds = clouds_of(args);
  FilePlan plan{{}, {}, args.overwrite};
  if (!args.envelope.empty()) plan.inputs.push_back({args.envelope});
  for (const OneOfMany& cloud : clouds) {
    if (cloud.input == "-") throw_usage("stdin is one cloud, without a name: --each needs files");
    const auto frame = static_cast<std::int64_t>(plan.outputs.size());
    plan.inputs.push_back({cloud.input, frame});
    plan.outputs.push_back({"-o", cloud.output, OutputKind::file, frame});
    if (!cloud.report.empty()) plan.outputs.push_back({"--report", cloud.report, OutputKind::report, frame});
  }
  check_distinct_names(clouds);
  check_files(plan);
  std::set<std::filesystem::path> folders;
  for (const OneOfMany& cloud : clouds) {
    if (folders.insert(std::filesystem::path(cloud.output).parent_path()).second) check_mesh_output(cloud.output);
    if (!cloud.report.empty() && folders.insert(std::filesystem::path(cloud.report).parent_path()).second)
      check_replaceable(cloud.report);
  }
}

int reconstruct_each(const ReconstructArgs& given) {
  const Stopwatch watch;
  ReconstructArgs args = given;
  args.options.envelope = read_envelope(args.envelope, args.threads);
  const Device device = args.chosen();
  std::vector<OneOfMany> clouds = clouds_of(args);
  on_interrupt(OnInterrupt::remember);
  Batch batch(args, device, clouds);
  batch.run();
  throw_if_failed(clouds);
  if (args.quiet) return 0;
  std::int64_t points = 0, triangles = 0;
  std::vector<double> ms;
  for (const OneOfMany& cloud : clouds) {
    points += cloud.points;
    triangles += cloud.triangles;
    ms.push_back(cloud.ms);
  }
  print_note(fmt::format("{}: clouds {}, points {}, triangles {}; ms: {:.1f} in the middle, total {:.1f}; {} at once",
                         args.output, clouds.size(), points, triangles, spread_of(ms).median, watch.ms(),
                         batch.at_once()));
  return 0;
}

}  // namespace pointskin::cli
