#include "exec/cpu.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <vector>

#ifdef POINTSKIN_STD_THREAD
#include <atomic>
#include <mutex>
#include <thread>
#else
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace pointskin::exec {
namespace {

constexpr std::size_t kAlignment = 256;

/// Sizes are rounded up to four classes per octave, so that a block fits later requests of about its size.
std::size_t size_class(std::size_t bytes) {
  if (bytes <= 4096) return 4096;
  const std::size_t step = std::bit_floor(bytes - 1) / 4;
  return (bytes + step - 1) / step * step;
}

/// Keeps freed blocks in one list per size class.
class CpuPool final : public MemoryPool {
 public:
  CpuPool() = default;
  ~CpuPool() override { CpuPool::trim(); }
  CpuPool(const CpuPool&) = delete;
  CpuPool& operator=(const CpuPool&) = delete;

  void trim() noexcept override {
    for (const Block& block : free_)
      std::free(block.data);  // NOLINT(cppcoreguidelines-no-malloc): pairs with aligned_alloc
    free_.clear();
  }

 private:
  struct Block {
    std::size_t bytes;
    void* data;
  };

  void* take(std::size_t bytes) override {
    const std::size_t rounded = size_class(bytes);
    const auto hit = std::find_if(free_.rbegin(), free_.rend(), [&](const Block& b) { return b.bytes == rounded; });
    if (hit != free_.rend()) {
      void* data = hit->data;
      free_.erase(std::next(hit).base());
      return data;
    }
    void* data = std::aligned_alloc(kAlignment, rounded);
    if (data == nullptr) {
      trim();
      data = std::aligned_alloc(kAlignment, rounded);
    }
    if (data == nullptr)
      throw Error(ErrorCode::over_limit,
                  "out of memory on the CPU; while allocating " + std::to_string(bytes) + " bytes");
    return data;
  }

  void give_back(void* block, std::size_t bytes) noexcept override {
    try {
      free_.push_back({size_class(bytes), block});
    } catch (...) {
      std::free(block);  // NOLINT(cppcoreguidelines-no-malloc): no room to remember the block
    }
  }

  std::vector<Block> free_;
};

}  // namespace

#ifdef POINTSKIN_STD_THREAD

struct Cpu::Workers {
  explicit Workers(int count) : threads(count) {}
  int threads;
};

static int available_threads() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

void Cpu::run_blocks(std::int64_t count, const std::function<void(std::int64_t)>& block) {
  std::atomic<std::int64_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    for (std::int64_t i = next++; i < count; i = next++) {
      try {
        block(i);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  };
  // A thread is started for 16 blocks at least: starting one takes longer than a block.
  std::vector<std::thread> helpers;
  for (std::int64_t t = 1; t < std::min<std::int64_t>(workers_->threads, 1 + count / 16); ++t)
    helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
}

#else

static int available_threads() { return tbb::info::default_concurrency(); }

struct Cpu::Workers {
  explicit Workers(int count) : arena(count) {
    // oneTBB would ignore, and complain on stderr about, more threads than cores. The smallest of all living limits
    // counts, so limits are only ever raised: no space slows another one down.
    if (count > available_threads()) more_threads.emplace(tbb::global_control::max_allowed_parallelism, count);
  }
  std::optional<tbb::global_control> more_threads;
  tbb::task_arena arena;
};

void Cpu::run_blocks(std::int64_t count, const std::function<void(std::int64_t)>& block) {
  if (count == 1) return block(0);
  workers_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::int64_t>(0, count, 1),
        [&](const tbb::blocked_range<std::int64_t>& range) {
          for (std::int64_t i = range.begin(); i < range.end(); ++i) block(i);
        },
        tbb::simple_partitioner());
  });
}

#endif

Cpu::Cpu(int threads) : threads_(threads > 0 ? threads : available_threads()), pool_(std::make_shared<CpuPool>()) {
  if (threads < 0) throw Error(ErrorCode::usage, "the number of threads must not be negative");
  workers_ = std::make_unique<Workers>(threads_);
}

Cpu::~Cpu() = default;

}  // namespace pointskin::exec
