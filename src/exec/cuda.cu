#include "exec/cuda.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "exec/cpu.hpp"
#include "exec/cuda_check.cuh"

namespace pointskin::exec {
namespace {

/// Allocates in stream order from a driver's pool of its own whose release threshold is unlimited. Blocks up to
/// kLargestKept bytes do not even go back there when they are freed: asking the driver takes longer than a small
/// kernel. Work on the one stream is ordered, so a block may be handed out while its last user is still running.
class CudaPool final : public MemoryPool {
 public:
  CudaPool(int index, cudaStream_t stream, bool owns_stream) : stream_(stream), owns_stream_(owns_stream) {
    cudaMemPoolProps properties{};
    properties.allocType = cudaMemAllocationTypePinned;
    properties.location.type = cudaMemLocationTypeDevice;
    properties.location.id = index;
    cuda_check(cudaMemPoolCreate(&pool_, &properties), "creating the memory pool");
    std::uint64_t keep_all = ~std::uint64_t{0};
    cuda_check(cudaMemPoolSetAttribute(pool_, cudaMemPoolAttrReleaseThreshold, &keep_all),
               "setting up the memory pool");
  }
  ~CudaPool() override {
    CudaPool::trim();
    cudaMemPoolDestroy(pool_);
    if (owns_stream_) cudaStreamDestroy(stream_);
  }
  CudaPool(const CudaPool&) = delete;
  CudaPool& operator=(const CudaPool&) = delete;

  void trim() noexcept override {
    for (auto& [bytes, blocks] : kept_) {
      for (void* block : blocks) cudaFreeAsync(block, stream_);
      blocks.clear();
    }
    cudaStreamSynchronize(stream_);
    cudaMemPoolTrimTo(pool_, 0);
  }

 private:
  void* take(std::size_t bytes) override {
    const std::size_t rounded = size_class(bytes);
    if (const auto kept = kept_.find(rounded); kept != kept_.end() && !kept->second.empty()) {
      void* block = kept->second.back();
      kept->second.pop_back();
      return block;
    }
    void* block = nullptr;
    cudaError_t status = cudaMallocFromPoolAsync(&block, rounded, pool_, stream_);
    if (status == cudaErrorMemoryAllocation) {
      cudaGetLastError();
      trim();
      status = cudaMallocFromPoolAsync(&block, rounded, pool_, stream_);
    }
    if (status == cudaErrorMemoryAllocation) {
      cudaGetLastError();
      throw Error(ErrorCode::over_limit, "out of memory on the GPU; while allocating " + std::to_string(bytes) +
                                             " bytes with " + std::to_string(held_bytes()) +
                                             " held; choose a smaller depth or a larger GPU");
    }
    cuda_check(status, "allocating device memory");
    return block;
  }
  void give_back(void* block, std::size_t bytes) noexcept override {
    const std::size_t rounded = size_class(bytes);
    try {
      if (rounded <= kLargestKept) return kept_[rounded].push_back(block);
    } catch (...) {  // NOLINT(bugprone-empty-catch): no room to remember the block, so it is freed
    }
    cudaFreeAsync(block, stream_);
  }

  static constexpr std::size_t kLargestKept = std::size_t{32} << 20;

  /// Four classes per octave, so that a block fits later requests of about its size; large blocks as they are.
  static std::size_t size_class(std::size_t bytes) {
    if (bytes <= 4096) return 4096;
    if (bytes > kLargestKept) return bytes;
    const std::size_t step = std::bit_floor(bytes - 1) / 4;
    return (bytes + step - 1) / step * step;
  }

  std::unordered_map<std::size_t, std::vector<void*>> kept_;
  cudaStream_t stream_;
  bool owns_stream_;
  cudaMemPool_t pool_ = nullptr;
};

}  // namespace

namespace {

void choose(int index) {
  if (index < 0 || index >= cuda_device_count())
    throw Error(ErrorCode::device_unavailable,
                "no GPU number " + std::to_string(index) + " answers; check nvidia-smi or choose --device cpu");
  cuda_check(cudaSetDevice(index), "choosing the GPU");
}

cudaStream_t make_stream(int index) {
  choose(index);
  cudaStream_t stream = nullptr;
  cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "creating a stream");
  return stream;
}

}  // namespace

/// Page-locked blocks of the host's memory, each for one thread at a time: the bus copies to and from them alone.
class Cuda::Lanes {
 public:
  static constexpr std::size_t kBytes = std::size_t{2} << 20;
  static constexpr int kCount = 8;

  Lanes() = default;
  ~Lanes() { cudaFreeHost(memory_); }
  Lanes(const Lanes&) = delete;
  Lanes& operator=(const Lanes&) = delete;

  /// Calls use(block) with a block of kBytes; waits until one is free. The memory is taken at the first call.
  template <class Use>
  void with_block(const Use& use) {
    const int lane = take();
    try {
      use(memory_ + static_cast<std::size_t>(lane) * kBytes);
    } catch (...) {
      give_back(lane);
      throw;
    }
    give_back(lane);
  }

 private:
  int take() {
    std::unique_lock lock(mutex_);
    if (memory_ == nullptr) {
      cuda_check(cudaMallocHost(reinterpret_cast<void**>(&memory_), kCount * kBytes), "allocating page-locked memory");
      for (int lane = 0; lane < kCount; ++lane) free_.push_back(lane);
    }
    freed_.wait(lock, [&] { return !free_.empty(); });
    const int lane = free_.back();
    free_.pop_back();
    return lane;
  }
  void give_back(int lane) {
    {
      const std::lock_guard lock(mutex_);
      free_.push_back(lane);
    }
    freed_.notify_one();
  }

  std::mutex mutex_;  // guards what follows
  std::condition_variable freed_;
  std::vector<int> free_;
  char* memory_ = nullptr;
};

Cuda::Cuda(int index) : Cuda(index, make_stream(index), true) {}
Cuda::Cuda(int index, void* stream) : Cuda(index, stream, false) {}

Cuda::Cuda(int index, void* stream, bool owns_stream)
    : index_(index), stream_(stream), lanes_(std::make_unique<Lanes>()) {
  choose(index);
  cuda_check(cudaDeviceGetAttribute(&multiprocessors_, cudaDevAttrMultiProcessorCount, index),
             "reading the GPU's properties");
  pool_ = std::make_shared<CudaPool>(index, static_cast<cudaStream_t>(stream),
                                     owns_stream);  // owns the stream: buffers may outlive this object
  cuda_check(cudaMallocHost(&staging_, kStagingBytes + sizeof(std::uint32_t)), "allocating page-locked memory");
  arrived_ = reinterpret_cast<std::uint32_t*>(static_cast<char*>(staging_) + kStagingBytes);
  *arrived_ = ticket_;
  for (void*& mark : marks_) {
    cudaEvent_t event = nullptr;
    cuda_check(cudaEventCreate(&event), "creating a timer");
    mark = event;
  }
}

Cuda::~Cuda() {
  cudaFreeHost(staging_);
  for (void* mark : marks_) cudaEventDestroy(static_cast<cudaEvent_t>(mark));
}

Cuda::Mark Cuda::mark() {
  const int mark = next_mark_;
  next_mark_ = (next_mark_ + 1) % kMarks;
  cuda_check(cudaEventRecord(static_cast<cudaEvent_t>(marks_[mark]), static_cast<cudaStream_t>(stream_)), "timing");
  return mark;
}

double Cuda::milliseconds_between(Mark from, Mark to) const {
  cuda_check(cudaEventSynchronize(static_cast<cudaEvent_t>(marks_[to])), "waiting for the GPU");
  float milliseconds = 0;
  cuda_check(
      cudaEventElapsedTime(&milliseconds, static_cast<cudaEvent_t>(marks_[from]), static_cast<cudaEvent_t>(marks_[to])),
      "timing");
  return milliseconds;
}

void Cuda::synchronize() {
  cuda_check(cudaStreamSynchronize(static_cast<cudaStream_t>(stream_)), "waiting for the GPU");
}

void Cuda::wait_for(std::uint32_t ticket) {
  constexpr auto kSoon = std::chrono::microseconds(200);  // a longer wait may cost a few microseconds more, and no core
  const auto begin = std::chrono::steady_clock::now();
  while (*arrived_ != ticket) {
    if (std::chrono::steady_clock::now() - begin < kSoon) continue;
    synchronize();
    break;
  }
  std::atomic_thread_fence(std::memory_order_acquire);
}

template <class Copy>
void Cuda::copy_in_parts(std::size_t bytes, const Copy& copy) {
  synchronize();
  const auto parts = static_cast<std::int64_t>((bytes + Lanes::kBytes - 1) / Lanes::kBytes);
  Cpu(Lanes::kCount).run_blocks(parts, [&](std::int64_t part) {
    const std::size_t at = static_cast<std::size_t>(part) * Lanes::kBytes;
    copy(at, std::min(Lanes::kBytes, bytes - at));
  });
}

void Cuda::fetch(const void* from, void* to, std::size_t bytes) {
  copy_in_parts(bytes, [&](std::size_t at, std::size_t part) {
    read(static_cast<const char*>(from) + at, static_cast<char*>(to) + at, part);
  });
}

void Cuda::send(const void* from, void* to, std::size_t bytes) {
  copy_in_parts(bytes, [&](std::size_t at, std::size_t part) {
    cuda_check(cudaSetDevice(index_), "choosing the GPU");
    lanes_->with_block([&](char* block) {
      std::memcpy(block, static_cast<const char*>(from) + at, part);
      cuda_check(cudaMemcpyAsync(static_cast<char*>(to) + at, block, part, cudaMemcpyHostToDevice, cudaStreamPerThread),
                 "copying to the GPU");
      cuda_check(cudaStreamSynchronize(cudaStreamPerThread), "copying to the GPU");
    });
  });
}

void Cuda::read(const void* from, void* to, std::size_t bytes) const {
  cuda_check(cudaSetDevice(index_), "choosing the GPU");
  for (std::size_t at = 0; at < bytes; at += Lanes::kBytes) {
    const std::size_t part = std::min(Lanes::kBytes, bytes - at);
    lanes_->with_block([&](char* block) {
      cuda_check(cudaMemcpyAsync(block, static_cast<const char*>(from) + at, part, cudaMemcpyDeviceToHost,
                                 cudaStreamPerThread),
                 "copying to the host");
      cuda_check(cudaStreamSynchronize(cudaStreamPerThread), "copying to the host");
      std::memcpy(static_cast<char*>(to) + at, block, part);
    });
  }
}

void Cuda::activate() { cuda_check(cudaSetDevice(index_), "choosing the GPU"); }

int cuda_device_count() noexcept {
  int count = 0;
  if (cudaGetDeviceCount(&count) != cudaSuccess) {
    cudaGetLastError();  // a missing driver is an answer, not a failure to remember
    return 0;
  }
  return count;
}

std::string cuda_device_name(int index) {
  cudaDeviceProp properties{};
  cuda_check(cudaGetDeviceProperties(&properties, index), "reading the GPU's properties");
  return properties.name;
}

std::int64_t cuda_free_bytes(int index) {
  int current = 0;
  std::size_t free = 0;
  std::size_t total = 0;
  cuda_check(cudaGetDevice(&current), "reading the current GPU");
  cuda_check(cudaSetDevice(index), "choosing the GPU");
  cuda_check(cudaMemGetInfo(&free, &total), "reading the GPU's free memory");
  cuda_check(cudaSetDevice(current), "choosing the GPU");
  return static_cast<std::int64_t>(free);
}

}  // namespace pointskin::exec
