#include "exec/host_array.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>

namespace pointskin::exec {

void populate([[maybe_unused]] Cpu& ex, [[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE  // Linux 5.14
  constexpr std::uintptr_t kPage = 4096;
  constexpr std::uintptr_t kBlock = std::uintptr_t{1} << 20;
  const std::uintptr_t first = (reinterpret_cast<std::uintptr_t>(data) + kPage - 1) / kPage * kPage;
  const std::uintptr_t end = (reinterpret_cast<std::uintptr_t>(data) + bytes) / kPage * kPage;
  if (end < first + kBlock) return;  // not worth a system call
  ex.run_blocks(static_cast<std::int64_t>((end - first + kBlock - 1) / kBlock), [&](std::int64_t b) {
    const std::uintptr_t at = first + static_cast<std::uintptr_t>(b) * kBlock;
    ::madvise(reinterpret_cast<void*>(at), std::min(kBlock, end - at), MADV_POPULATE_WRITE);
  });
#endif
}

}  // namespace pointskin::exec
