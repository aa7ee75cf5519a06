#include "workbench/compare/measures.hpp"

#include <gtest/gtest.h>

using namespace workbench;

TEST(Measures, TheBestIsMarkedAndNoneWhereAllAreEqual) {
  EXPECT_EQ(best_of(std::vector<double>{2, 1, 1}, false), (std::vector<bool>{false, true, true}));
  EXPECT_EQ(best_of(std::vector<double>{2, 1, 1}, true), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(best_of(std::vector<double>{1, 1}, true), (std::vector<bool>{false, false}));
  EXPECT_EQ(best_of({}, true), std::vector<bool>{});
}

TEST(Measures, SpeedsHaveDigitsHoweverSlowAndADashWhereNoRayWasTraced) {
  const auto& speed = ray_measures().back();
  EXPECT_EQ(speed.format(7.0712), "7.071");
  EXPECT_EQ(speed.format(0.1712), "0.171");
  EXPECT_EQ(speed.format(0.00021349), "0.000213");
  EXPECT_EQ(speed.format(0.0), "-");
}

TEST(Measures, NumbersReadWell) {
  EXPECT_EQ(format_ratio(1.0, 2.0), "0.50×");
  EXPECT_EQ(format_ratio(1.0, 0.0), "");
  EXPECT_EQ(format_alpha(0.0f), "0");
  EXPECT_EQ(format_alpha(1.0f), "1");
  EXPECT_EQ(format_alpha(0.1f), "0.1");
  EXPECT_EQ(format_alpha(1e-3f), "1e-3");
  EXPECT_EQ(format_alpha(1e-5f), "1e-5");
  EXPECT_EQ(format_alpha(2.5e-7f), "2.5e-7");
}

TEST(Measures, SpeedsOfRayTypesCombineByTime) {
  BuilderFigures builder;
  builder.rays[0] = {.count = 1000, .mrays_per_s = 1.0};  // 1 ms
  builder.rays[1] = {.count = 3000, .mrays_per_s = 1.0};  // 3 ms
  EXPECT_NEAR(rays_per_second(builder, {RayType::primary, RayType::ao}), 1e6, 1e-3);
  builder.rays[1].mrays_per_s = 3.0;  // 1 ms
  EXPECT_NEAR(rays_per_second(builder, {RayType::primary, RayType::ao}), 2e6, 1e-3);
  EXPECT_EQ(rays_per_second({}, {RayType::primary}), 0.0);
}
