#include "exec/cpu_pool.hpp"

#include <pointskin/error.hpp>

#include <sys/mman.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <vector>

// g++ says so by a macro, clang by a feature.
#if defined(__SANITIZE_ADDRESS__)
#define POINTSKIN_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define POINTSKIN_ADDRESS_SANITIZER
#endif
#endif

namespace pointskin::exec {
namespace {

constexpr std::size_t kAlignment = 256;
constexpr std::size_t kPage = 4096;
constexpr std::size_t kHugePage = std::size_t{1} << 21;

/// Part of the most ever used that may be cached on top: what a run takes is to be what it was said to take.
constexpr std::size_t kSpareShare = 64;

/// Blocks from here on are cut from ranges. The address sanitizer watches the blocks of malloc only.
#ifdef POINTSKIN_ADDRESS_SANITIZER
constexpr std::size_t kLargeBytes = std::numeric_limits<std::size_t>::max();
#else
constexpr std::size_t kLargeBytes = std::size_t{1} << 18;
#endif

constexpr std::size_t round_up(std::size_t bytes, std::size_t to) { return (bytes + to - 1) / to * to; }

/// Keeps freed blocks in one list for all sizes.
class SmallBlocks {
 public:
  /// @returns nullptr if the system has no such memory
  void* take(std::size_t bytes) {
    const std::size_t rounded = size_class(bytes);
    const auto hit = std::find_if(free_.rbegin(), free_.rend(), [&](const Block& b) { return b.bytes == rounded; });
    if (hit == free_.rend()) return std::aligned_alloc(kAlignment, rounded);
    void* data = hit->data;
    free_.erase(std::next(hit).base());
    return data;
  }

  void give_back(void* block, std::size_t bytes) noexcept {
    try {
      free_.push_back({size_class(bytes), block});
    } catch (...) {
      std::free(block);  // NOLINT(cppcoreguidelines-no-malloc): no room to remember the block
    }
  }

  void trim() noexcept {
    for (const Block& block : free_)
      std::free(block.data);  // NOLINT(cppcoreguidelines-no-malloc): pairs with aligned_alloc
    free_.clear();
  }

 private:
  struct Block {
    std::size_t bytes;
    void* data;
  };

  /// Sizes are rounded up to four classes per octave, so that a block fits later requests of about its size.
  static std::size_t size_class(std::size_t bytes) {
    if (bytes <= kPage) return kPage;
    const std::size_t step = std::bit_floor(bytes - 1) / 4;
    return (bytes + step - 1) / step * step;
  }

  std::vector<Block> free_;
};

/// Cuts blocks from mapped ranges of whole pages, wherever the fit is best.
class LargeBlocks {
 public:
  /// @returns nullptr if the system has no such memory
  void* take(std::size_t bytes) {
    const std::size_t rounded = round_up(bytes, kPage);
    auto range = best_fit(rounded);
    if (range == free_.end()) range = map(rounded);
    if (range == free_.end()) return nullptr;
    char* block = range->first;
    const std::size_t rest = range->second - rounded;
    auto node = free_.extract(range);  // used again: taking memory must not fail for want of a node
    if (rest > 0) {
      node.key() = block + rounded;
      node.mapped() = rest;
      free_.insert(std::move(node));
    }
    cached_ -= rounded;
    used_ += rounded;
    most_used_ = std::max(most_used_, used_);
    return block;
  }

  void give_back(void* block, std::size_t bytes) noexcept {
    const std::size_t rounded = round_up(bytes, kPage);
    used_ -= rounded;
    try {
      insert(static_cast<char*>(block), rounded);
    } catch (...) {
      ::munmap(block, rounded);  // no room to remember the block
    }
  }

  void trim() noexcept { release(cached_); }

  /// Used and cached memory stay below `bytes` as far as what is used does; 0: no limit.
  void set_limit(std::size_t bytes) noexcept {
    limit_ = bytes > 0 ? bytes : std::numeric_limits<std::size_t>::max();
    if (used_ + cached_ > limit_) release(used_ + cached_ - limit_);
  }

  /// Gives at least `bytes` of what is cached back to the system, or all, the ends of the largest ranges first.
  void release(std::size_t bytes) noexcept {
    while (bytes > 0 && !free_.empty()) {
      const auto largest = std::max_element(free_.begin(), free_.end(),
                                            [](const auto& a, const auto& b) { return a.second < b.second; });
      const std::size_t part = std::min(largest->second, round_up(bytes, kHugePage));
      ::munmap(largest->first + (largest->second - part), part);
      largest->second -= part;
      if (largest->second == 0) free_.erase(largest);
      cached_ -= part;
      bytes -= std::min(bytes, part);
    }
  }

 private:
  using Ranges = std::map<char*, std::size_t>;  ///< free bytes by their address; no two of them touch

  Ranges::iterator best_fit(std::size_t bytes) {
    auto best = free_.end();
    for (auto range = free_.begin(); range != free_.end(); ++range)
      if (range->second >= bytes && (best == free_.end() || range->second < best->second)) best = range;
    return best;
  }

  /// A free range of new memory for `bytes`, aligned to huge pages; end() if there is none. Huge pages are left to the
  /// system's own setting: asked for, they doubled the time of first touches on virtual machines.
  Ranges::iterator map(std::size_t bytes) {
    if (bytes > std::numeric_limits<std::size_t>::max() / 2) return free_.end();
    const std::size_t wanted = round_up(bytes, kHugePage);
    const std::size_t most = std::max(most_used_, used_ + bytes);
    const std::size_t together = std::min(most + most / kSpareShare, std::max(limit_, used_ + bytes));
    const std::size_t allowed = together - used_ - bytes;
    if (cached_ > allowed) release(cached_ - allowed);
    void* mapping = ::mmap(nullptr, wanted + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapping == MAP_FAILED) return free_.end();
    auto* first = static_cast<char*>(mapping);
    char* aligned = first + (kHugePage - reinterpret_cast<std::uintptr_t>(first) % kHugePage) % kHugePage;
    if (aligned != first) ::munmap(first, static_cast<std::size_t>(aligned - first));
    ::munmap(aligned + wanted, kHugePage - static_cast<std::size_t>(aligned - first));
    return insert(aligned, wanted);
  }

  /// Adds a free range and merges it with those that it touches.
  Ranges::iterator insert(char* first, std::size_t bytes) {
    auto range = free_.emplace(first, bytes).first;
    cached_ += bytes;
    const auto after = std::next(range);
    if (after != free_.end() && after->first == first + bytes) {
      range->second += after->second;
      free_.erase(after);
    }
    if (range == free_.begin()) return range;
    const auto before = std::prev(range);
    if (before->first + before->second != first) return range;
    before->second += range->second;
    free_.erase(range);
    return before;
  }

  Ranges free_;
  std::size_t used_ = 0;
  std::size_t cached_ = 0;
  std::size_t most_used_ = 0;
  std::size_t limit_ = std::numeric_limits<std::size_t>::max();
};

class CpuPool final : public MemoryPool {
 public:
  CpuPool() = default;
  ~CpuPool() override { CpuPool::trim(); }
  CpuPool(const CpuPool&) = delete;
  CpuPool& operator=(const CpuPool&) = delete;

  void trim() noexcept override {
    small_.trim();
    large_.trim();
  }
  void set_limit(std::int64_t bytes) noexcept override {
    MemoryPool::set_limit(bytes);
    large_.set_limit(static_cast<std::size_t>(limit()));
  }
  void release_cached(std::int64_t bytes) noexcept override { large_.release(static_cast<std::size_t>(bytes)); }

 private:
  void* take(std::size_t bytes) override {
    void* block = try_to_take(bytes);
    if (block == nullptr) {
      trim();
      block = try_to_take(bytes);
    }
    if (block == nullptr)
      throw Error(ErrorCode::over_limit,
                  "out of memory on the CPU; while allocating " + std::to_string(bytes) + " bytes");
    return block;
  }

  void* try_to_take(std::size_t bytes) { return bytes < kLargeBytes ? small_.take(bytes) : large_.take(bytes); }

  void give_back(void* block, std::size_t bytes) noexcept override {
    if (bytes < kLargeBytes)
      small_.give_back(block, bytes);
    else
      large_.give_back(block, bytes);
  }

  SmallBlocks small_;
  LargeBlocks large_;
};

}  // namespace

std::shared_ptr<MemoryPool> make_cpu_pool() { return std::make_shared<CpuPool>(); }

}  // namespace pointskin::exec
