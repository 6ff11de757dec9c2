// Registers benchmarks of templates for one space: NAME.cpp registers them for the CPU, NAME.cu for the first GPU.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>

#include "exec/cpu.hpp"
#ifdef __CUDACC__
#include "exec/cuda.hpp"
#endif

namespace pointskin::bench {

template <class Space>
struct SpaceTraits;

template <>
struct SpaceTraits<exec::Cpu> {
  static constexpr const char* kName = "cpu";
  static bool answers() { return true; }
  static exec::Cpu& get() {
    static exec::Cpu space;
    return space;
  }
};

#ifdef __CUDACC__
template <>
struct SpaceTraits<exec::Cuda> {
  static constexpr const char* kName = "cuda";
  static bool answers() { return exec::cuda_device_count() > 0; }
  static exec::Cuda& get() {
    static exec::Cuda& space = *new exec::Cuda(0);  // never destroyed: CUDA goes first at the end of a process
    return space;
  }
};
#endif

/// Wall clock per call of `work`, everything it has started included.
template <class Space, class Work>
void time_on(Space& ex, benchmark::State& state, const Work& work) {
  work();  // memory comes from the pool afterwards
  ex.synchronize();
  for (auto _ : state) {
    work();
    ex.synchronize();
  }
}

/// Registers `body` as "name/space", if the space answers. To be called before main().
template <class Space, class Body>
void add_benchmark(const std::string& name, const Body& body,
                   const std::function<void(benchmark::internal::Benchmark*)>& arguments) {
  if (!SpaceTraits<Space>::answers()) return;
  benchmark::internal::Benchmark* added =
      benchmark::RegisterBenchmark((name + "/" + SpaceTraits<Space>::kName).c_str(),
                                   [body](benchmark::State& state) { body(SpaceTraits<Space>::get(), state); });
  arguments(added->UseRealTime());
}

}  // namespace pointskin::bench
