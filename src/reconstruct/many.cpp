#include "reconstruct/many.hpp"

#include <pointskin/cancel.hpp>
#include <pointskin/error.hpp>
#include <pointskin/processors.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <new>
#include <numeric>
#include <optional>
#include <utility>

#include "exec/cancel.hpp"

namespace pointskin::detail {
namespace {

/// How many clouds are done, told to the caller, who may end it all.
class Tally {
 public:
  Tally(const Options& options, std::size_t total) : told_(options.progress), total_(static_cast<double>(total)) {}

  /// @throws Error interrupted
  void add() {
    const std::lock_guard lock(mutex_);
    if (!stopped_) stopped_ = told_ && !told_({"many", ++done_ / total_});
    if (stopped_) exec::throw_cancelled();
  }
  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  const std::function<bool(const Progress&)>& told_;
  double total_;
  std::mutex mutex_;  // guards done_, and calls of told_
  double done_ = 0;
  std::atomic<bool> stopped_{false};
};

/// @throws Error interrupted
Reconstruction reconstruct_one(Reconstructor& reconstructor, const Cloud& cloud, const Options& options) {
  Reconstruction result;
  try {
    result.mesh = reconstructor.reconstruct(cloud, options);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) throw;
    result.error = error;
  } catch (const std::bad_alloc&) {
    result.error = Error(ErrorCode::over_limit, "the system has no memory left");
  }
  result.report = reconstructor.report();
  return result;
}

/// Those of every cloud: between the steps of a run only the end of all is asked for.
Options options_of_one(const Options& options, const Tally& tally) {
  Options one = options;
  one.progress = [&tally](const Progress&) { return !tally.stopped(); };
  return one;
}

/// The largest cloud first; equal ones in their order.
std::vector<std::size_t> by_size(std::span<const Cloud> clouds) {
  std::vector<std::size_t> order(clouds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return clouds[a].size() > clouds[b].size(); });
  return order;
}

/// Streams of a GPU that work at once: launches and waits of one overlap the work of others, and small clouds leave most of a GPU
/// idle (bench/many.cpp).
constexpr int kStreams = 12;

/// Clouds of more points fill a GPU, or several as one.
constexpr std::int64_t kFillsGpu = 200'000;
constexpr std::int64_t kFillsGpus = 20'000'000;

std::vector<Device> devices_of(const Device& device) {
  if (device.kind == DeviceKind::cpu) return {Device::cpu(1)};
  std::vector<Device> devices;
  for (const int gpu : device.gpus()) {
    Device one = device;
    one.index = gpu;
    one.further.clear();
    devices.push_back(one);
  }
  return devices;
}

int at_once_on(const Device& device) {
  if (device.kind == DeviceKind::cpu) return device.threads;
  return std::clamp(usable_processors(), 2, kStreams * static_cast<int>(device.gpus().size()));
}

/// How many clouds of `order` are to have the whole device: on the CPU those that would still be worked on when all others are
/// done, and whose memory should not be taken many times at once.
std::size_t count_alone(std::span<const Cloud> clouds, const std::vector<std::size_t>& order, const Device& device,
                        int at_once) {
  constexpr std::int64_t kGainsByThreads = 20'000;
  constexpr std::int64_t kLarge = 1'000'000;
  std::int64_t left = 0;
  for (const Cloud& cloud : clouds) left += cloud.size();
  std::size_t alone = 0;
  for (; alone < order.size(); ++alone) {
    const std::int64_t points = clouds[order[alone]].size();
    const bool is_alone = device.kind == DeviceKind::cpu
                              ? points > kLarge || (points >= kGainsByThreads && points * at_once > left)
                              : points > (device.further.empty() ? kFillsGpu : kFillsGpus);
    if (!is_alone) break;
    left -= points;
  }
  return alone;
}

}  // namespace

Crew::Crew(const Device& device) : devices_(devices_of(device)), cpu_(at_once_on(device)) {}

std::unique_ptr<Reconstructor> Crew::take() {
  std::size_t device = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<Reconstructor> reconstructor = std::move(idle_.back());
      idle_.pop_back();
      return reconstructor;
    }
    device = made_++ % devices_.size();
  }
  return std::make_unique<Reconstructor>(devices_[device]);
}

void Crew::put_back(std::unique_ptr<Reconstructor> reconstructor) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(reconstructor));
}

bool Crew::release_memory() {
  const std::lock_guard lock(mutex_);
  const bool had_some = !idle_.empty();
  idle_.clear();
  return had_some;
}

bool Crew::ran_out_of_gpu_memory(const Reconstruction& result) const {
  return devices_.front().kind != DeviceKind::cpu && result.error && result.error->code() == ErrorCode::over_limit;
}

Reconstruction Crew::reconstruct_alone(const Cloud& cloud, const Options& options, Reconstructor& whole) {
  Reconstruction result = reconstruct_one(whole, cloud, options);
  if (ran_out_of_gpu_memory(result) && release_memory()) result = reconstruct_one(whole, cloud, options);
  return result;
}

Reconstruction Crew::reconstruct_beside(const Cloud& cloud, const Options& options) {
  Reconstruction result;
  try {
    std::unique_ptr<Reconstructor> reconstructor = take();
    result = reconstruct_one(*reconstructor, cloud, options);
    if (!ran_out_of_gpu_memory(result)) put_back(std::move(reconstructor));
  } catch (const Error& error) {  // also of take()
    if (error.code() == ErrorCode::interrupted) throw;
    result.error = error;
  }
  return result;
}

std::vector<Reconstruction> Crew::reconstruct(std::span<const Cloud> clouds, const Options& options,
                                              Reconstructor& whole) {
  constexpr std::int64_t kKeptBytes = std::int64_t{1} << 30;  // of a GPU, from one call to the next
  std::vector<Reconstruction> results(clouds.size());
  Tally tally(options, clouds.size());
  const Options one = options_of_one(options, tally);
  const std::vector<std::size_t> order = by_size(clouds);
  const bool on_gpu = devices_.front().kind != DeviceKind::cpu;
  const std::size_t alone = count_alone(clouds, order, whole.device(), cpu_.threads());
  for (std::size_t i = 0; i < alone; ++i) {
    results[order[i]] = reconstruct_alone(clouds[order[i]], one, whole);
    tally.add();
  }
  if (on_gpu && alone > 0) whole.workspace().release_memory();
  const std::atomic<bool>* const cancelled = exec::cancel_flag();
  std::mutex mutex;                // guards what follows
  std::vector<std::size_t> again;  // those for which the others left no memory
  std::int64_t peak_bytes = 0;     // of one run
  std::atomic<std::size_t> next{alone};
  cpu_.run_blocks(static_cast<std::int64_t>(order.size() - alone), [&](std::int64_t /*any*/) {
    std::optional<CancelScope> scope;
    if (cancelled != nullptr) scope.emplace(*cancelled);
    const std::size_t i = order[next++];
    results[i] = reconstruct_beside(clouds[i], one);
    const bool is_done = !ran_out_of_gpu_memory(results[i]);
    {
      const std::lock_guard lock(mutex);
      peak_bytes = std::max(peak_bytes, results[i].report.device_peak_bytes);
      if (!is_done) again.push_back(i);
    }
    if (is_done) tally.add();
  });
  if (on_gpu && (!again.empty() || peak_bytes * cpu_.threads() > kKeptBytes)) release_memory();
  for (const std::size_t i : again) {
    results[i] = reconstruct_alone(clouds[i], one, whole);
    tally.add();
  }
  return results;
}

std::vector<Reconstruction> reconstruct_in_turn(std::span<const Cloud> clouds, const Options& options,
                                                Reconstructor& reconstructor) {
  std::vector<Reconstruction> results;
  results.reserve(clouds.size());
  Tally tally(options, clouds.size());
  const Options one = options_of_one(options, tally);
  for (const Cloud& cloud : clouds) {
    results.push_back(reconstruct_one(reconstructor, cloud, one));
    tally.add();
  }
  return results;
}

}  // namespace pointskin::detail
