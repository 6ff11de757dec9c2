#include "reconstruct/many.hpp"

#include <pointskin/cancel.hpp>
#include <pointskin/error.hpp>

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

/// How many clouds of `order` are to have all threads: those that would still be worked on when all others are done, or
/// whose memory should not be taken many times at once.
std::size_t count_alone(std::span<const Cloud> clouds, const std::vector<std::size_t>& order, int threads) {
  constexpr std::int64_t kGainsByThreads = 20'000;
  constexpr std::int64_t kLarge = 1'000'000;
  std::int64_t left = 0;
  for (const Cloud& cloud : clouds) left += cloud.size();
  std::size_t alone = 0;
  for (; alone < order.size(); ++alone) {
    const std::int64_t points = clouds[order[alone]].size();
    if (points <= kLarge && (points < kGainsByThreads || points * threads <= left)) break;
    left -= points;
  }
  return alone;
}

}  // namespace

std::unique_ptr<Reconstructor> Crew::take() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<Reconstructor> reconstructor = std::move(idle_.back());
      idle_.pop_back();
      return reconstructor;
    }
  }
  return std::make_unique<Reconstructor>(Device::cpu(1));
}

void Crew::put_back(std::unique_ptr<Reconstructor> reconstructor) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(reconstructor));
}

std::vector<Reconstruction> Crew::reconstruct(std::span<const Cloud> clouds, const Options& options,
                                              Reconstructor& all_threads) {
  std::vector<Reconstruction> results(clouds.size());
  Tally tally(options, clouds.size());
  const Options one = options_of_one(options, tally);
  const std::vector<std::size_t> order = by_size(clouds);
  const std::size_t alone = count_alone(clouds, order, cpu_.threads());
  for (std::size_t i = 0; i < alone; ++i) {
    results[order[i]] = reconstruct_one(all_threads, clouds[order[i]], one);
    tally.add();
  }
  const std::atomic<bool>* const cancelled = exec::cancel_flag();
  std::atomic<std::size_t> next{alone};
  cpu_.run_blocks(static_cast<std::int64_t>(order.size() - alone), [&](std::int64_t /*any*/) {
    std::optional<CancelScope> scope;
    if (cancelled != nullptr) scope.emplace(*cancelled);
    const std::size_t i = order[next++];
    std::unique_ptr<Reconstructor> reconstructor = take();
    results[i] = reconstruct_one(*reconstructor, clouds[i], one);
    put_back(std::move(reconstructor));
    tally.add();
  });
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
