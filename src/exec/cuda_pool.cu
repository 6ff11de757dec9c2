#include "exec/cuda_pool.hpp"

#include <pointskin/error.hpp>

#include <bit>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "exec/cuda_check.cuh"

namespace pointskin::exec {
namespace {

/// Allocates in stream order from a driver's pool of its own whose release threshold is unlimited. Blocks up to
/// kLargestKept bytes do not even go back there when they are freed: asking the driver takes longer than a small
/// kernel. Work on the one stream is ordered, so a block may be handed out while its last user is still running.
class CudaPool final : public MemoryPool {
 public:
  CudaPool(int index, cudaStream_t stream, bool owns_stream, std::span<const int> readers)
      : stream_(stream), owns_stream_(owns_stream), index_(index), readers_(readers.begin(), readers.end()) {
    cudaMemPoolProps properties{};
    properties.allocType = cudaMemAllocationTypePinned;
    properties.location.type = cudaMemLocationTypeDevice;
    properties.location.id = index;
    cuda_check(cudaMemPoolCreate(&pool_, &properties), "creating the memory pool");
    std::uint64_t keep_all = ~std::uint64_t{0};
    cuda_check(cudaMemPoolSetAttribute(pool_, cudaMemPoolAttrReleaseThreshold, &keep_all),
               "setting up the memory pool");
    for (const int reader : readers) {
      cudaMemAccessDesc access{};
      access.location.type = cudaMemLocationTypeDevice;
      access.location.id = reader;
      access.flags = cudaMemAccessFlagsProtReadWrite;
      cuda_check(cudaMemPoolSetAccess(pool_, &access, 1), "giving another GPU access to the memory pool");
    }
  }
  ~CudaPool() override {
    CudaPool::trim();
    cudaMemPoolDestroy(pool_);
    if (owns_stream_) cudaStreamDestroy(stream_);
  }
  CudaPool(const CudaPool&) = delete;
  CudaPool& operator=(const CudaPool&) = delete;

  void trim() noexcept override {
    wait_for_readers();
    for (auto& [bytes, blocks] : kept_) {
      for (void* block : blocks) cudaFreeAsync(block, stream_);
      blocks.clear();
    }
    cudaStreamSynchronize(stream_);
    cudaMemPoolTrimTo(pool_, 0);
  }

 private:
  /// Work of theirs may still use blocks that are free.
  void wait_for_readers() const noexcept {
    if (readers_.empty()) return;
    int current = index_;
    cudaGetDevice(&current);
    for (const int reader : readers_) {
      cudaSetDevice(reader);
      cudaDeviceSynchronize();
    }
    cudaSetDevice(current);
  }

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
  int index_;
  std::vector<int> readers_;
  cudaMemPool_t pool_ = nullptr;
};

}  // namespace

std::shared_ptr<MemoryPool> make_cuda_pool(int index, void* stream, bool owns_stream, std::span<const int> readers) {
  return std::make_shared<CudaPool>(index, static_cast<cudaStream_t>(stream), owns_stream, readers);
}

}  // namespace pointskin::exec
