#include <gtest/gtest.h>

#include "workbench/compare/table.hpp"

using namespace workbench;

TEST(ComparisonTable, SaysHowManyHitsDiffer) {
  SceneFigures scene{.name = "s", .triangles = 1, .degenerate_triangles = 0, .builders = {}};
  scene.builders.resize(2);
  scene.builders[1].disagreements = 7;
  EXPECT_NE(format_comparison(scene, Emphasis::mark).find("7 HITS DIFFER"), std::string::npos);
}
