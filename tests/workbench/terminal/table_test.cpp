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

TEST(Table, FoldsIntoBlocksThatBeginWithTheNames) {
  const std::vector<Column> columns{
      {.head = "name", .cells = {{"a"}, {"b"}}, .left_aligned = true, .gap = ""},
      {.head = "first", .cells = {{"1"}, {"2"}}},
      {.head = "", .cells = {{"x1"}, {"x2"}}, .gap = " "},
      {.head = "second", .cells = {{"3"}, {"4"}}}};
  EXPECT_EQ(format(columns, Emphasis::mark, 15),
            "name  first\n"
            "a         1 x1\n"
            "b         2 x2\n"
            "\n"
            "name  second\n"
            "a          3\n"
            "b          4\n");
}

TEST(Table, WrapsALastColumnOfText) {
  const std::vector<Column> columns{
      {.head = "scene", .cells = {{"a"}, {"b"}}, .left_aligned = true, .gap = ""},
      {.head = "", .cells = {{"long plain walls beside fine columns"}, {"short"}}, .left_aligned = true}};
  EXPECT_EQ(format(columns, Emphasis::mark, 34),
            "scene\n"
            "a      long plain walls beside\n"
            "       fine columns\n"
            "b      short\n");
}

TEST(Table, CountsHaveACommaBeforeEachThousand) {
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(999), "999");
  EXPECT_EQ(format_count(1000), "1,000");
  EXPECT_EQ(format_count(1000001), "1,000,001");
  EXPECT_EQ(format_count(0, "triangle", "triangles"), "0 triangles");
  EXPECT_EQ(format_count(1, "triangle", "triangles"), "1 triangle");
  EXPECT_EQ(format_count(1000, "triangle", "triangles"), "1,000 triangles");
}
