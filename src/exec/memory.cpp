#include "exec/memory.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <string>

namespace pointskin::exec {

void* MemoryPool::allocate(std::size_t bytes) {
  const auto more = static_cast<std::int64_t>(bytes);
  if (limit_ > 0 && more > limit_ - held_)
    throw Error(ErrorCode::over_limit, "out of the " + std::to_string(limit_) + " bytes that are allowed; while " +
                                           std::to_string(held_) + " were held and " + std::to_string(bytes) +
                                           " more were needed");
  void* block = take(bytes);
  held_ += more;
  peak_ = std::max(peak_, held_);
  return block;
}

void MemoryPool::deallocate(void* block, std::size_t bytes) noexcept {
  give_back(block, bytes);
  held_ -= static_cast<std::int64_t>(bytes);
}

}  // namespace pointskin::exec
