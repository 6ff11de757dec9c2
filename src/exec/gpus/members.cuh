// The GPUs of a group with what each has of its own.
#pragma once

#include <cuda_runtime_api.h>

#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "exec/cuda_check.cuh"
#include "exec/gpus/layout.hpp"
#include "exec/memory.hpp"

namespace pointskin::exec::gpus {

struct Destroy {
  void operator()(cudaStream_t stream) const noexcept { cudaStreamDestroy(stream); }
  void operator()(cudaEvent_t event) const noexcept { cudaEventDestroy(event); }
};
using Event = std::unique_ptr<std::remove_pointer_t<cudaEvent_t>, Destroy>;

/// Lives as long as the group or memory of it.
class Members {
 public:
  explicit Members(std::span<const int> gpus);
  ~Members() { synchronize(); }
  Members(const Members&) = delete;
  Members& operator=(const Members&) = delete;

  struct Member {
    int gpu = 0;
    cudaStream_t stream = nullptr;
    Event mark;
    std::shared_ptr<MemoryPool> pool;  // owns the stream
  };

  [[nodiscard]] int count() const noexcept { return static_cast<int>(all_.size()); }
  [[nodiscard]] const Member& operator[](int g) const { return all_[static_cast<std::size_t>(g)]; }

  // What an Order asks for.
  void record(int g) {
    cuda_check(cudaEventRecord((*this)[g].mark.get(), (*this)[g].stream), "marking the work of a GPU");
  }
  void wait(int g, int other) {
    cuda_check(cudaStreamWaitEvent((*this)[g].stream, (*this)[other].mark.get(), 0),
               "letting GPUs wait for each other");
  }

  void synchronize() const noexcept {
    for (const Member& member : all_) cudaStreamSynchronize(member.stream);
  }

 private:
  std::vector<Member> all_;
};

/// The group's memory: blocks of `least_spread_bytes` and more are cut as `layout` says when they are taken. @see Group::pool
std::shared_ptr<MemoryPool> make_spread_pool(std::shared_ptr<Members> members, std::shared_ptr<const Layout> layout,
                                             std::size_t least_spread_bytes);

}  // namespace pointskin::exec::gpus
