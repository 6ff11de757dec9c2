// The primitives on the GPU. Same bodies and references as on the CPU: what both pass is equal bit by bit.
#include "unit/exec/primitives_tests.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnGpu, Primitives, CudaSpaces);

}  // namespace pointskin::test
