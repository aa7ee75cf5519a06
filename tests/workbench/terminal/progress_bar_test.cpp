#include <gtest/gtest.h>

#include "workbench/terminal/progress.hpp"

using namespace workbench;

TEST(ProgressBar, FitsTheTerminal) {
  EXPECT_EQ(draw_bar(0.5, "a long word", 45).size(), draw_bar(0.5, "a lon", 80).size());
  EXPECT_NE(draw_bar(2.0, "", 80).find("100 %"), std::string::npos);
  EXPECT_NE(draw_bar(-1.0, "", 80).find("  0 %"), std::string::npos);
}
