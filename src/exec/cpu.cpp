#include "exec/cpu.hpp"

#include <pointskin/error.hpp>
#include <pointskin/processors.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "exec/cancel.hpp"
#include "exec/cpu_pool.hpp"
#include "exec/cpu_threads.hpp"

#ifdef POINTSKIN_STD_THREAD
#include <system_error>
#else
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace pointskin::exec {

#ifdef POINTSKIN_STD_THREAD

struct Cpu::Workers {
  explicit Workers(int count) : threads(count) {}
  int threads;
};

static int available_threads() { return usable_processors(); }

void Cpu::run_blocks(std::int64_t count, const std::function<void(std::int64_t)>& block) {
  std::atomic<std::int64_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const std::atomic<bool>* const cancelled = cancel_flag();
  const auto work = [&] {
    for (std::int64_t i = next++; i < count; i = next++) {
      try {
        throw_if_cancelled(cancelled);
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
  try {
    for (std::int64_t t = 1; t < std::min<std::int64_t>(workers_->threads, 1 + count / 16); ++t)
      helpers.emplace_back(work);
  } catch (const std::system_error&) {  // NOLINT(bugprone-empty-catch): those that could be made do all the work
  }
  work();
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
}

#else

/// Where the first call finds no memory, all later ones of oneTBB 2021 would wait for it forever: they are not made.
static int available_threads() {
  static std::mutex& mutex = *new std::mutex;  // never destroyed: spaces may outlive statics
  static bool is_lost = false;
  const std::lock_guard lock(mutex);
  if (is_lost) throw std::bad_alloc();
  try {
    return tbb::info::default_concurrency();
  } catch (...) {
    is_lost = true;
    throw;
  }
}

using Arena = std::unique_ptr<tbb::task_arena>;
using Arenas = std::vector<Arena>;

/// Arenas that no space uses now. oneTBB 2021 keeps 7 KB for every arena that ever was, so they are used again.
class IdleArenas {
 public:
  /// Never destroyed: spaces may outlive statics.
  static IdleArenas& instance() {
    static IdleArenas& arenas = *new IdleArenas;
    return arenas;
  }

  Arena take(int threads) {
    {
      const std::lock_guard lock(mutex_);
      Arenas& idle = idle_[threads];
      if (!idle.empty()) {
        Arena arena = std::move(idle.back());
        idle.pop_back();
        return arena;
      }
    }
    return std::make_unique<tbb::task_arena>(threads);
  }

  void put_back(int threads, Arena arena) {
    const std::lock_guard lock(mutex_);
    idle_[threads].push_back(std::move(arena));
  }

 private:
  std::mutex mutex_;
  std::map<int, Arenas> idle_;  // by number of threads
};

/// oneTBB makes threads when it first needs them. The system may refuse one that it allowed a moment before.
template <class Work>
void with_threads(const Work& work) {
  try {
    work();
  } catch (const Error&) {
    throw;
  } catch (const std::runtime_error& error) {
    if (!std::string_view(error.what()).starts_with("pthread_create")) throw;
    throw Error(ErrorCode::over_limit, "the system does not let more threads be made; use fewer threads");
  }
}

/// Has oneTBB make its threads now, by work that no thread ends before all have come. oneTBB makes threads when it first
/// needs them, and ends the process if the system then refuses.
void make_threads_now(tbb::task_arena& arena, int count) {
  constexpr std::chrono::milliseconds kLongest{200};
  const auto give_up = std::chrono::steady_clock::now() + kLongest;
  std::atomic<int> here{0};
  const auto meet = [&](const tbb::blocked_range<int>& /*one*/) {
    ++here;
    while (here < count && std::chrono::steady_clock::now() < give_up) std::this_thread::yield();
  };
  with_threads([&] {
    arena.execute([&] { tbb::parallel_for(tbb::blocked_range<int>(0, count, 1), meet, tbb::simple_partitioner()); });
  });
}

/// oneTBB would ignore, and complain on stderr about, more threads than cores. The smallest of all its limits counts, so
/// there is one for the process, which is only ever raised: no space slows another one down.
void allow_threads(int count) {
  static std::mutex& mutex = *new std::mutex;  // never destroyed: spaces may outlive statics
  static std::optional<tbb::global_control>& limit = *new std::optional<tbb::global_control>;
  static int allowed = available_threads();
  const std::lock_guard lock(mutex);
  if (count <= allowed) return;
  limit.reset();
  limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
  allowed = count;
}

struct Cpu::Workers {
  explicit Workers(int count) : threads(count), arena(IdleArenas::instance().take(count)) {
    allow_threads(count);
    if (count == 1 || !threads_are_limited()) return;
    static std::atomic<int> made_already{1};
    if (made_already >= count) return;
    make_threads_now(ready_arena(), count);
    made_already = count;
  }
  ~Workers() {
    if (arena) IdleArenas::instance().put_back(threads, std::move(arena));
  }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Whoever uses an arena of oneTBB 2021 whose beginning has once failed, for want of memory, waits forever.
  tbb::task_arena& ready_arena() {
    if (!arena) arena = std::make_unique<tbb::task_arena>(threads);
    try {
      arena->initialize();
    } catch (...) {
      arena.reset();
      throw;
    }
    return *arena;
  }

  int threads;
  Arena arena;
};

void Cpu::run_blocks(std::int64_t count, const std::function<void(std::int64_t)>& block) {
  const std::atomic<bool>* const cancelled = cancel_flag();
  if (threads_ == 1 || count <= 1) {  // nothing to share: a launch would cost more than a small block
    for (std::int64_t i = 0; i < count; ++i) {
      throw_if_cancelled(cancelled);
      block(i);
    }
    return;
  }
  with_threads([&] {
    workers_->ready_arena().execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::int64_t>(0, count, 1),
          [&](const tbb::blocked_range<std::int64_t>& range) {
            for (std::int64_t i = range.begin(); i < range.end(); ++i) {
              throw_if_cancelled(cancelled);
              block(i);
            }
          },
          tbb::simple_partitioner());
    });
  });
}

#endif

static int number_of_threads(int wanted) {
  if (wanted < 0) throw Error(ErrorCode::usage, "the number of threads must not be negative");
  const int available = available_threads();
  return threads_that_can_be_made(wanted > 0 ? wanted : available, available);
}

Cpu::Cpu(int threads) : threads_(number_of_threads(threads)), pool_(make_cpu_pool()) {
  workers_ = std::make_unique<Workers>(threads_);
}

Cpu::~Cpu() = default;

}  // namespace pointskin::exec
