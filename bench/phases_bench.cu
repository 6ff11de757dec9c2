#include "exec/cuda_primitives.cuh"
#include "phases_bench.hpp"

namespace pointskin::bench {
namespace {

[[maybe_unused]] const bool kAdded = add_phases<exec::Cuda>();

}  // namespace
}  // namespace pointskin::bench
