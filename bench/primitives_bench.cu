#include "exec/cuda_primitives.cuh"
#include "primitives_bench.hpp"

namespace pointskin::bench {
namespace {

[[maybe_unused]] const bool kAdded = add_primitives<exec::Cuda>();

}  // namespace
}  // namespace pointskin::bench
