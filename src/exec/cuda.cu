#include "exec/cuda.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "exec/cpu.hpp"
#include "exec/cuda_check.cuh"
#include "exec/cuda_pool.hpp"

namespace pointskin::exec {
namespace {

void check_answers(int index) {
  if (index < 0 || index >= cuda_device_count())
    throw Error(ErrorCode::device_unavailable,
                "no GPU number " + std::to_string(index) + " answers; check nvidia-smi or choose --device cpu");
}

void choose(int index) {
  check_answers(index);
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

Cuda::Cuda(int index) : Cuda(std::span<const int>(&index, 1)) {}

Cuda::Cuda(int index, void* stream) : Cuda(open(index, stream)) {}
Cuda::Cuda(std::span<const int> gpus) : Cuda(open(gpus)) {}

Cuda::Opened Cuda::open(int index, void* stream) {
  choose(index);
  return {index, stream, nullptr, make_cuda_pool(index, stream, false)};
}

Cuda::Opened Cuda::open(std::span<const int> gpus) {
  for (const int gpu : gpus) check_answers(gpu);
  const int lead = gpus.front();
  if (gpus.size() == 1) {
    void* stream = make_stream(lead);
    return {lead, stream, nullptr, make_cuda_pool(lead, stream, true)};  // owns it: buffers may outlive this object
  }
  auto group = std::make_unique<gpus::Group>(gpus);
  void* stream = group->stream(0);
  const std::shared_ptr<MemoryPool> pool = group->pool();
  return {lead, stream, std::move(group), pool};
}

Cuda::Cuda(Opened opened)
    : index_(opened.index),
      stream_(opened.stream),
      lanes_(std::make_unique<Lanes>()),
      group_(std::move(opened.group)),
      pool_(std::move(opened.pool)) {
  cuda_check(cudaDeviceGetAttribute(&multiprocessors_, cudaDevAttrMultiProcessorCount, index_),
             "reading the GPU's properties");
  cuda_check(cudaMallocHost(&staging_, 2 * kStagingBytes + sizeof(std::uint32_t)), "allocating page-locked memory");
  arrived_ = reinterpret_cast<std::uint32_t*>(static_cast<char*>(staging_) + 2 * kStagingBytes);
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
  join();
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
  if (group_ != nullptr) return group_->synchronize();
  cuda_check(cudaStreamSynchronize(static_cast<cudaStream_t>(stream_)), "waiting for the GPU");
}

void Cuda::wait_for(std::uint32_t ticket) {
  constexpr auto kSoon = std::chrono::microseconds(200);  // a longer wait may cost a few microseconds more, and no core
  const auto begin = std::chrono::steady_clock::now();
  while (static_cast<std::int32_t>(*arrived_ - ticket) < 0) {
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
    if (group_ != nullptr)
      group_->choose(static_cast<int>(part * group_->count() / parts));
    else
      activate();
    copy(at, std::min(Lanes::kBytes, bytes - at));
  });
  activate();
}

void Cuda::fetch(const void* from, void* to, std::size_t bytes) {
  copy_in_parts(bytes, [&](std::size_t at, std::size_t part) {
    copy_to_host(static_cast<const char*>(from) + at, static_cast<char*>(to) + at, part);
  });
}

void Cuda::send(const void* from, void* to, std::size_t bytes) {
  copy_in_parts(bytes, [&](std::size_t at, std::size_t part) {
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
  copy_to_host(from, to, bytes);
}

void Cuda::copy_to_host(const void* from, void* to, std::size_t bytes) const {
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
