#include "support/thread_ranks.hpp"

#include <pointskin/error.hpp>

#include <condition_variable>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace pointskin::test {
namespace {

/// Where threads meet.
class Hub {
 public:
  explicit Hub(int count) : count_(count) {}

  /// All have the bytes of the root when they leave.
  void broadcast(void* data, std::int64_t bytes, bool is_root) {
    if (is_root) message_ = data;
    if (is_root) bytes_ = bytes;
    meet();
    if (bytes != bytes_) throw std::logic_error("ranks wait for different messages");
    if (!is_root && bytes > 0) std::memcpy(data, message_, static_cast<std::size_t>(bytes));
    meet();
  }

  void fail(std::exception_ptr why) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::move(why);
    changed_.notify_all();
  }
  [[nodiscard]] std::exception_ptr failure() const { return failure_; }

 private:
  void meet() {
    std::unique_lock lock(mutex_);
    const std::int64_t meeting = meeting_;
    if (++here_ == count_) {
      here_ = 0;
      ++meeting_;
      changed_.notify_all();
      return;
    }
    changed_.wait(lock, [&] { return meeting_ != meeting || failure_; });
    if (meeting_ == meeting) throw Error(ErrorCode::interrupted, "another rank has met an error");
  }

  int count_, here_ = 0;
  std::int64_t meeting_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::exception_ptr failure_;
  const void* message_ = nullptr;
  std::int64_t bytes_ = 0;
};

class ThreadRanks final : public Ranks {
 public:
  ThreadRanks(Hub& hub, int rank, int size) : hub_(hub), rank_(rank), size_(size) {}
  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }
  [[nodiscard]] int rank_on_host() const override { return rank_; }
  void broadcast(void* data, std::int64_t bytes, int root) override { hub_.broadcast(data, bytes, root == rank_); }
  [[noreturn]] void end_all(int /*exit_code*/) override { std::abort(); }

 private:
  Hub& hub_;
  int rank_, size_;
};

}  // namespace

void run_as_ranks(int count, const std::function<void(Ranks&)>& work) {
  Hub hub(count);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < count; ++rank)
    threads.emplace_back([&, rank] {
      try {
        ThreadRanks ranks(hub, rank, count);
        work(ranks);
      } catch (...) {
        hub.fail(std::current_exception());
      }
    });
  for (std::thread& thread : threads) thread.join();
  if (hub.failure()) std::rethrow_exception(hub.failure());
}

}  // namespace pointskin::test
