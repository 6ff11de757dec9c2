#include <pointskin/processors.hpp>

#include <gtest/gtest.h>

#include <sched.h>

#include <thread>

namespace pointskin {
namespace {

TEST(Processors, AreThoseThatTheThreadMayRunOn) {
  EXPECT_GE(usable_processors(), 1);
  EXPECT_LE(usable_processors(), static_cast<int>(std::thread::hardware_concurrency()));
  std::thread([] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(::sched_getcpu()), &one);
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(usable_processors(), 1);
  }).join();
}

}  // namespace
}  // namespace pointskin
