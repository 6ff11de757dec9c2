// Memory of a space: a pool that keeps what is freed, and move-only arrays taken from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/array_view.hpp"

namespace pointskin::exec {

/// Memory of one space. Freed blocks stay with the pool for the next request; trim() gives them back.
/// Blocks are aligned to at least 256 bytes. Used from one thread at a time.
class MemoryPool {
 public:
  virtual ~MemoryPool() = default;
  MemoryPool() = default;
  MemoryPool(const MemoryPool&) = delete;
  MemoryPool& operator=(const MemoryPool&) = delete;

  /// @throws Error over_limit, naming the size, when the space has no such memory left or the limit would be passed
  void* allocate(std::size_t bytes);
  void deallocate(void* block, std::size_t bytes) noexcept;

  /// Gives cached blocks back to the system.
  virtual void trim() noexcept = 0;
  /// The same, but no more than about `bytes` of them: for a caller that is about to take as much of the same memory
  /// elsewhere.
  virtual void release_cached(std::int64_t /*bytes*/) noexcept {}

  /// What all blocks may hold together, in bytes; 0: no limit but the lasting one. What is held already stays.
  virtual void set_limit(std::int64_t bytes) noexcept {
    limit_ = bytes > 0 && (lasting_limit_ == 0 || bytes < lasting_limit_) ? bytes : lasting_limit_;
  }
  /// The same, for every run from now on; 0: none.
  void set_lasting_limit(std::int64_t bytes) noexcept {
    lasting_limit_ = bytes;
    set_limit(bytes);
  }
  [[nodiscard]] std::int64_t limit() const noexcept { return limit_; }
  [[nodiscard]] std::int64_t lasting_limit() const noexcept { return lasting_limit_; }

  [[nodiscard]] std::int64_t held_bytes() const noexcept { return held_; }
  [[nodiscard]] std::int64_t peak_bytes() const noexcept { return peak_; }
  void reset_peak() noexcept { peak_ = held_; }

 private:
  virtual void* take(std::size_t bytes) = 0;
  virtual void give_back(void* block, std::size_t bytes) noexcept = 0;

  std::int64_t held_ = 0;
  std::int64_t peak_ = 0;
  std::int64_t limit_ = 0;
  std::int64_t lasting_limit_ = 0;
};

/// An array of trivially copyable T, uninitialised, in the space of its pool, which it keeps alive; or one of somebody
/// else's. Move-only.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(std::shared_ptr<MemoryPool> pool, std::int64_t size) : pool_(std::move(pool)), size_(size) {
    if (size_ > 0) data_ = static_cast<T*>(pool_->allocate(bytes()));
  }
  /// Memory of somebody else, who keeps it: not freed here.
  static Buffer borrowed(T* data, std::int64_t size) noexcept {
    Buffer buffer;
    buffer.data_ = data;
    buffer.size_ = size;
    return buffer;
  }
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer(std::move(other)).swap(*this);
    return *this;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() {
    if (pool_ != nullptr && data_ != nullptr) pool_->deallocate(data_, bytes());
  }

  [[nodiscard]] T* data() const noexcept { return data_; }
  [[nodiscard]] std::int64_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] ArrayView<T> view() const noexcept { return {data_, size_}; }
  [[nodiscard]] ArrayView<const T> cview() const noexcept { return {data_, size_}; }

  /// Frees the array now.
  void reset() noexcept { Buffer().swap(*this); }
  void swap(Buffer& other) noexcept {
    std::swap(pool_, other.pool_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
  }

 private:
  /// Never wraps around: a size beyond all memory stays one, and the pool refuses it.
  [[nodiscard]] std::size_t bytes() const noexcept {
    constexpr std::size_t kBeyondAllMemory = std::size_t{1} << 62;
    const auto count = static_cast<std::size_t>(size_);
    return count > kBeyondAllMemory / sizeof(T) ? kBeyondAllMemory : count * sizeof(T);
  }

  std::shared_ptr<MemoryPool> pool_;
  T* data_ = nullptr;
  std::int64_t size_ = 0;
};

}  // namespace pointskin::exec
