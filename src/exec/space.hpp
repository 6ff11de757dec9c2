// What an algorithm may ask of a space. Algorithms are templates over `Space`; only exec/ knows which there are.
//
// Primitives, found by argument-dependent lookup on the space (exec/cpu_primitives.hpp, exec/cuda_primitives.cuh):
//
//   for_each(ex, "label", n, f)                f(i) for every i in [0, n)
//   for_each_apart(ex, "label", n, f)          the same, for f that takes another path for every i
//   lanes_apart(ex, n)                         threads that for_each_apart gives an index
//   for_each_long(ex, "label", n, f)           the same, for few indices that take long
//   for_each_by_lanes(ex, "label", n, f)       f.finish(i, s) for every i in [0, n), s the sum of f.part(i, lane) over
//                                              F::kLanes lanes in the order of lanes.hpp
//   sweep(ex, "label", rounds, n, f)           f(round, i, f.prepare(i)) for every i in [0, n), or [0, f.indices(round))
//                                              where f has that, with f.takes_part(i), rounds one after another; what
//                                              prepare returns must not change meanwhile
//   reduce_tail(ex, "label", values, out, combine)  the last step of reduce: few values to one; with kOwnKernels also
//                                              reduce_any_order, for combinations that are exact (reduce_order.hpp)
//   select(ex, "label", n, keep)               Buffer<int32> of the i in [0, n) with keep(i), ascending
//   exclusive_scan(ex, "label", in, out)       out[i] = in[0] + ... + in[i-1]; out may have one element more: the total
//   sort_pairs(ex, "label", keys, values, bits, first_bit)  stable ascending radix sort by these bits of uint64 keys
//   sort_keys(ex, "label", keys, bits)         the same for keys alone, by the lowest `bits` bits
//   copy_to_host / copy_to_device / copy       checked copies on the space's stream
//   copy_constant_to_device                    of what never changes: does not wait
//
// and, written once over for_each, in exec/algorithms.hpp: fill, gather, iota, reduce, reduce_in_space,
// read_element, copy_to_host_meanwhile, select_meanwhile, run_starts (run-length encoding: a run's length is the distance
// to the next start) and sort_unique.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "exec/memory.hpp"

namespace pointskin::exec {

template <class T>
concept Space = requires(T ex) {
  { ex.pool() } -> std::convertible_to<std::shared_ptr<MemoryPool>>;
  { T::kManyThreads } -> std::convertible_to<bool>;  // true: the smallest pieces of work run best
  { T::kOnHost } -> std::convertible_to<bool>;       // true: what a Buffer holds is the host's memory
  // true: a step whose generic form asks for !kOwnKernels has one of its own for this space, or does not compile
  { T::kOwnKernels } -> std::convertible_to<bool>;
  { ex.host_threads() } -> std::convertible_to<int>;  // for what is done on the host meanwhile; 0: all
  ex.synchronize();
  ex.read(nullptr, nullptr, std::size_t{});  // memory of the space to the host's, from any thread
  { ex.milliseconds_between(ex.mark(), ex.mark()) } -> std::convertible_to<double>;
  ex.activate();
};

/// An uninitialised array of `size` elements in the space `ex`.
/// @throws Error over_limit if the space has no memory left
template <class T, Space Exec>
Buffer<T> make_buffer(Exec& ex, std::int64_t size) {
  return Buffer<T>(ex.pool(), size);
}

}  // namespace pointskin::exec
