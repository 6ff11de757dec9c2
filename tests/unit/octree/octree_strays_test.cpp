#include "unit/octree/stray_tests.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnCpu, StraysOn, CpuSpaces);

}  // namespace pointskin::test
