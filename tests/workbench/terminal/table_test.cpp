#include "workbench/terminal/table.hpp"

#include <gtest/gtest.h>

using namespace workbench;

TEST(Table, AlignsCharactersNotBytes) {
  const std::vector<Column> columns{
      {.head = "name", .cells = {{"α"}, {"beta"}}, .left_aligned = true, .gap = ""},
      {.head = "n", .cells = {{"1.00×", true}, {"10.00×"}}}};
  EXPECT_EQ(format(columns, Emphasis::mark),
            "name       n\n"
            "α      1.00×*\n"
            "beta  10.00×\n");
}

TEST(Table, IsBoldOnATerminalWithoutMovingColumns) {
  const std::vector<Column> columns{{.head = "n", .cells = {{"1", true}, {"22"}}, .gap = ""}};
  EXPECT_EQ(format(columns, Emphasis::bold), " n\n \033[1m1\033[0m\n22\n");
}
