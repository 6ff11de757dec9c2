#include "exec/memory.hpp"

#include <algorithm>

namespace pointskin::exec {

void* MemoryPool::allocate(std::size_t bytes) {
  void* block = take(bytes);
  held_ += static_cast<std::int64_t>(bytes);
  peak_ = std::max(peak_, held_);
  return block;
}

void MemoryPool::deallocate(void* block, std::size_t bytes) noexcept {
  give_back(block, bytes);
  held_ -= static_cast<std::int64_t>(bytes);
}

}  // namespace pointskin::exec
