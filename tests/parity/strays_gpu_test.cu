// Stray points on the GPU: the tests of all spaces.
#include "unit/octree/stray_tests.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnGpu, StraysOn, CudaSpaces);

}  // namespace pointskin::test
