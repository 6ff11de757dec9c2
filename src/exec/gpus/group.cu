#include "exec/gpus/group.hpp"

#include <pointskin/error.hpp>

#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "exec/cuda.hpp"
#include "exec/cuda_pool.hpp"
#include "exec/gpus/members.cuh"

namespace pointskin::exec::gpus {
namespace {

/// Whether one reads and writes the other's memory, also by atomic operations: over PCIe these are a read and a write.
bool does_reach(int gpu, int other) {
  int can = 0;
  int atomics = 0;
  cuda_check(cudaDeviceCanAccessPeer(&can, gpu, other), "asking which GPUs reach each other");
  if (can == 0) return false;
  cuda_check(cudaDeviceGetP2PAttribute(&atomics, cudaDevP2PAttrNativeAtomicSupported, gpu, other),
             "asking which GPUs reach each other");
  return atomics != 0;
}

/// Lets `gpu`, the current one, read and write what was allocated on `other`.
void reach(int gpu, int other) {
  if (!does_reach(gpu, other))
    throw Error(ErrorCode::device_unavailable, "GPU " + std::to_string(gpu) + " does not reach the memory of GPU " +
                                                   std::to_string(other) +
                                                   "; choose GPUs that are linked (nvidia-smi topo -p2p a), or one");
  const cudaError_t status = cudaDeviceEnablePeerAccess(other, 0);
  if (status == cudaErrorPeerAccessAlreadyEnabled)
    cudaGetLastError();
  else
    cuda_check(status, "giving a GPU access to another one's memory");
}

/// Makes the GPUs' contexts side by side: each takes a quarter of a second. What fails here fails again where it is told.
void start(std::span<const int> gpus) {
  std::vector<std::jthread> threads;
  threads.reserve(gpus.size());
  try {
    for (const int gpu : gpus)
      threads.emplace_back([gpu] {
        if (cudaSetDevice(gpu) == cudaSuccess) cudaFree(nullptr);
      });
  } catch (
      const std::system_error&) {  // NOLINT(bugprone-empty-catch): no more threads; those contexts are made one by one
  }
}

}  // namespace

bool work_together(std::span<const int> gpus) {
  for (const int gpu : gpus)
    for (const int other : gpus)
      if (gpu != other && !does_reach(gpu, other)) return false;
  return true;
}

WorthSharing& worth_sharing() {
  static WorthSharing worth;
  return worth;
}

Members::Members(std::span<const int> gpus) {
  all_.reserve(gpus.size());
  start(gpus);
  for (const int gpu : gpus) {
    cuda_check(cudaSetDevice(gpu), "choosing the GPU");
    for (const int other : gpus)
      if (other != gpu) reach(gpu, other);
  }
  for (const int gpu : gpus) {
    cuda_check(cudaSetDevice(gpu), "choosing the GPU");
    cudaStream_t stream = nullptr;
    cuda_check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "creating a stream");
    std::unique_ptr<std::remove_pointer_t<cudaStream_t>, Destroy> unowned(stream);
    std::vector<int> others;  // that use the lead's memory; the others' is their own
    if (gpu == gpus.front()) others.assign(gpus.begin() + 1, gpus.end());
    Member member{.gpu = gpu, .stream = stream, .mark = {}, .pool = make_cuda_pool(gpu, stream, true, others)};
    unowned.release();  // the pool owns it
    cudaEvent_t mark = nullptr;
    cuda_check(cudaEventCreateWithFlags(&mark, cudaEventDisableTiming), "creating an event");
    member.mark.reset(mark);
    all_.push_back(std::move(member));
  }
}

Group::Group(std::span<const int> gpus)
    : count_(static_cast<int>(gpus.size())),
      worth_(worth_sharing()),
      members_(std::make_shared<Members>(gpus)),
      layout_(std::make_shared<Layout>()),
      pool_(make_spread_pool(members_, layout_, worth_.bytes)),
      order_(count_) {
  choose(0);
}

Group::~Group() = default;

int Group::gpu(int g) const { return (*members_)[g].gpu; }
void* Group::stream(int g) const { return (*members_)[g].stream; }

Buffer<std::byte> Group::own_scratch(int g, std::size_t bytes) const {
  const auto size = static_cast<std::int64_t>(bytes);
  try {
    return {(*members_)[g].pool, size};
  } catch (const Error& error) {
    if (error.code() != ErrorCode::over_limit) throw;
  }
  pool_->trim();  // what is free in large ranges is the same memory
  choose(g);
  return {(*members_)[g].pool, size};
}

void Group::synchronize() {
  to_lead();
  for (int g = 0; g < count_; ++g)
    cuda_check(cudaStreamSynchronize(static_cast<cudaStream_t>(stream(g))), "waiting for the GPUs");
}

void Group::choose(int g) const { cuda_check(cudaSetDevice(gpu(g)), "choosing the GPU"); }
void Group::to_lead() { order_.to_lead(*members_); }
void Group::to_all() { order_.to_all(*members_); }
void Group::mark(int g) { members_->record(g); }

void Group::settle() noexcept {
  members_->synchronize();
  cudaSetDevice(gpu(0));
}

}  // namespace pointskin::exec::gpus
