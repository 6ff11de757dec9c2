#include "exec/cpu_threads.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <vector>

namespace pointskin::exec {
namespace {

constexpr int kMostThreads = 256;
constexpr std::size_t kStackBytes = std::size_t{4} << 20;  // oneTBB's
constexpr std::size_t kHeapBytes = std::size_t{64} << 20;  // addresses that glibc's malloc reserves for a thread

/// Bytes of address space that the process may still take; the largest number if there is no limit.
std::uint64_t free_address_space() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return ~std::uint64_t{0};
  std::ifstream sizes("/proc/self/statm");
  std::uint64_t pages = 0;
  sizes >> pages;
  const std::uint64_t used = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

void* wait_for(void* gate) {
  auto* mutex = static_cast<pthread_mutex_t*>(gate);
  pthread_mutex_lock(mutex);
  pthread_mutex_unlock(mutex);
  return nullptr;
}

/// Makes up to `count` threads that live at the same time, and ends them. @returns how many could be made
int try_to_make(int count) {
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return 0;
  pthread_attr_setstacksize(&attributes, kStackBytes);
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  std::vector<pthread_t> made;
  made.reserve(static_cast<std::size_t>(count));
  pthread_mutex_lock(&gate);
  for (int i = 0; i < count; ++i) {
    pthread_t thread{};
    if (pthread_create(&thread, &attributes, wait_for, &gate) != 0) break;
    made.push_back(thread);
  }
  pthread_mutex_unlock(&gate);
  for (const pthread_t thread : made) pthread_join(thread, nullptr);
  pthread_mutex_destroy(&gate);
  pthread_attr_destroy(&attributes);
  return static_cast<int>(made.size());
}

/// What was tried so far.
struct Known {
  std::mutex mutex;
  int possible = 1;          ///< so many are possible
  bool met_a_limit = false;  ///< no more than that
};

Known& known() {
  static Known& instance = *new Known;  // never destroyed: spaces may outlive statics
  return instance;
}

}  // namespace

int threads_that_can_be_made(int wanted, int available) {
  wanted = std::min(wanted, std::max(kMostThreads, available));
  Known& so_far = known();
  const std::lock_guard lock(so_far.mutex);
  if (wanted <= so_far.possible || so_far.met_a_limit) return std::min(wanted, so_far.possible);
  // Threads take half of a limited address space at most: the rest is for the work.
  const std::uint64_t fit = free_address_space() / 2 / (kStackBytes + kHeapBytes);
  const int others = static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(wanted) - 1, fit));
  const int made = others > 0 ? try_to_make(others) : 0;
  so_far.met_a_limit = made < wanted - 1;
  // Others may need some of what was left: a quarter stays free where the system refused.
  so_far.possible = std::max(so_far.possible, 1 + (made < others ? made / 4 * 3 : made));
  return so_far.possible;
}

bool threads_are_limited() {
  {
    Known& so_far = known();
    const std::lock_guard lock(so_far.mutex);
    if (so_far.met_a_limit) return true;
  }
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace pointskin::exec
