#include "exec/cuda.hpp"

#include <pointskin/error.hpp>

#include <string>

#include "exec/cuda_check.cuh"

namespace pointskin::exec {
namespace {

/// Allocates in stream order from a pool of its own whose release threshold is unlimited: memory freed stays for the
/// next request, so a steady state allocates nothing from the driver.
class CudaPool final : public MemoryPool {
 public:
  CudaPool(int index, cudaStream_t stream) : stream_(stream) {
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
    cudaStreamSynchronize(stream_);
    cudaMemPoolDestroy(pool_);
    cudaStreamDestroy(stream_);
  }
  CudaPool(const CudaPool&) = delete;
  CudaPool& operator=(const CudaPool&) = delete;

  void trim() noexcept override {
    cudaStreamSynchronize(stream_);
    cudaMemPoolTrimTo(pool_, 0);
  }

 private:
  void* take(std::size_t bytes) override {
    void* block = nullptr;
    const cudaError_t status = cudaMallocFromPoolAsync(&block, bytes, pool_, stream_);
    if (status == cudaErrorMemoryAllocation) {
      cudaGetLastError();
      throw Error(ErrorCode::over_limit, "out of memory on the GPU; while allocating " + std::to_string(bytes) +
                                             " bytes with " + std::to_string(held_bytes()) +
                                             " held; choose a smaller depth or a larger GPU");
    }
    cuda_check(status, "allocating device memory");
    return block;
  }
  void give_back(void* block, std::size_t /*bytes*/) noexcept override { cudaFreeAsync(block, stream_); }

  cudaStream_t stream_;
  cudaMemPool_t pool_ = nullptr;
};

}  // namespace

Cuda::Cuda(int index) : index_(index) {
  if (index < 0 || index >= cuda_device_count())
    throw Error(ErrorCode::device_unavailable,
                "no GPU number " + std::to_string(index) + " answers; check nvidia-smi or choose --device cpu");
  cuda_check(cudaSetDevice(index), "choosing the GPU");
  cudaStream_t stream = nullptr;
  cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "creating a stream");
  stream_ = stream;
  pool_ = std::make_shared<CudaPool>(index, stream);  // owns the stream: buffers may outlive this object
  cuda_check(cudaMallocHost(&staging_, kStagingBytes), "allocating page-locked memory");
}

Cuda::~Cuda() { cudaFreeHost(staging_); }

void Cuda::synchronize() {
  cuda_check(cudaStreamSynchronize(static_cast<cudaStream_t>(stream_)), "waiting for the GPU");
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
