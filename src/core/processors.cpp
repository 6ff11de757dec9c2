#include <pointskin/processors.hpp>

#include <sched.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <thread>

namespace pointskin {
namespace {

struct FreeSet {
  void operator()(cpu_set_t* set) const { CPU_FREE(set); }
};

/// @param room  processors that the set has room for
/// @returns 0 if the system knows more of them, else how many may be used, or -1 if it does not say
int count_usable(int room) noexcept {
  const std::unique_ptr<cpu_set_t, FreeSet> set(CPU_ALLOC(static_cast<std::size_t>(room)));
  if (set == nullptr) return -1;
  const std::size_t bytes = CPU_ALLOC_SIZE(static_cast<std::size_t>(room));
  CPU_ZERO_S(bytes, set.get());
  if (::sched_getaffinity(0, bytes, set.get()) != 0) return errno == EINVAL ? 0 : -1;
  return CPU_COUNT_S(bytes, set.get());
}

}  // namespace

int usable_processors() noexcept {
  constexpr int kMost = 1 << 20;
  int usable = 0;
  for (int room = 1024; usable == 0 && room <= kMost; room *= 2) usable = count_usable(room);
  return usable > 0 ? usable : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace pointskin
