#include "phases_bench.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::bench {
namespace {

[[maybe_unused]] const bool kAdded = add_phases<exec::Cpu>();

}  // namespace
}  // namespace pointskin::bench
