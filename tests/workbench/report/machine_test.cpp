// What measurements say of the machine they were made on.
#include "workbench/report/machine.hpp"

#include <gtest/gtest.h>

#ifdef __linux__
#include <sched.h>
#endif

namespace workbench {
namespace {

TEST(ThisMachine, HasAThreadThatCanBeUsed) {
  EXPECT_GE(usable_threads(), 1u);
  EXPECT_LE(usable_threads(), this_machine().threads);
}

#ifdef __linux__
TEST(ThisMachine, ThreadsThatAProcessIsKeptFromAreNotUsable) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  int first = 0;
  while (!CPU_ISSET(first, &before)) ++first;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(first, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
  EXPECT_EQ(usable_threads(), 1u);
  ASSERT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
}
#endif

}  // namespace
}  // namespace workbench
