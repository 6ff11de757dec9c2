#include "unit/edit/choice_tests.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnCpu, ChoiceOn, CpuSpaces);

}  // namespace pointskin::test
