// Values are copied where memory runs out: each allocation of a copy fails once.
#include <gtest/gtest.h>

#include <pointskin/attribute.hpp>

#include <cstdint>
#include <cstdlib>
#include <new>
#include <vector>

namespace {

int calls_left = -1;  ///< of operator new, until one fails; negative: none does

}  // namespace

// NOLINTBEGIN(cppcoreguidelines-no-malloc,hicpp-no-malloc)
void* operator new(std::size_t size) {
  if (calls_left >= 0 && calls_left-- == 0) throw std::bad_alloc();
  if (void* const memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
// The library's own form without an exception may not come to operator new above, whose memory the one below frees.
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }
// NOLINTEND(cppcoreguidelines-no-malloc,hicpp-no-malloc)

namespace pointskin {
namespace {

AttributeValues values_with_mask() {
  AttributeValues values(std::vector<std::int32_t>{1, 2, 3, 4});
  values.set_missing(2);
  return values;
}

/// @param copy  makes a copy @returns how many of its allocations failed, one a call, until all were there
template <class Copy>
int failed_copies(const Copy& copy) {
  for (int failed = 0;; ++failed) {
    calls_left = failed;
    try {
      copy();
      calls_left = -1;
      return failed;
    } catch (const std::bad_alloc&) {
      calls_left = -1;
    }
  }
}

TEST(AttributeMemory, ACopyThatFindsNoneLeavesNothing) {
  const AttributeValues values = values_with_mask();
  EXPECT_EQ(failed_copies([&] { EXPECT_EQ(AttributeValues(values).size(), 4u); }), 2);  // values and mask
}

TEST(AttributeMemory, AnAssignmentThatFindsNoneLeavesTheOldValues) {
  const AttributeValues values = values_with_mask();
  AttributeValues old(std::vector<double>{7});
  const AttributeValues before = old;
  const int failed = failed_copies([&] {
    try {
      old = values;
    } catch (const std::bad_alloc&) {
      calls_left = -1;
      EXPECT_EQ(old, before);
      throw;
    }
  });
  EXPECT_EQ(failed, 2);
  EXPECT_EQ(old, values);
}

TEST(AttributeMemory, AListOfAttributesThatFindsNoneLeavesNothing) {
  const Attribute attribute{"a name that is too long for its place", values_with_mask()};
  EXPECT_GE(failed_copies([&] { EXPECT_EQ((std::vector<Attribute>{attribute, attribute}).size(), 2u); }), 7);
}

}  // namespace
}  // namespace pointskin
