// Points that a view chooses, on the GPU: the tests of all spaces.
#include "unit/edit/choice_tests.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnGpu, ChoiceOn, CudaSpaces);

}  // namespace pointskin::test
