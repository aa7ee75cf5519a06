#include "support/targets.hpp"

#include <string_view>

#include <gtest/gtest.h>

#include "simd/dispatch.hpp"

namespace kerf {
namespace {

TEST(Targets, EndWithTheFallback) {
  ASSERT_FALSE(supported_targets().empty());
  EXPECT_STREQ(supported_targets().back().name, "SCALAR");
}

TEST(Targets, HaveATableEntryEach) {
  const auto targets = supported_targets();
  for (std::size_t i = 1; i < targets.size(); ++i)
    EXPECT_LT(targets[i - 1].table_index, targets[i].table_index) << targets[i].name;
}

TEST(Targets, AreChosenByTheEnvironment) {
  const auto chosen = [](const char* name) {
    const kerf_tests::ChosenTarget named(name);
    return std::string_view(choose_target().name);
  };
  for (const Target& target : supported_targets()) EXPECT_EQ(chosen(target.name), target.name);
  EXPECT_EQ(chosen("none such"), supported_targets().front().name);
  EXPECT_EQ(chosen(""), supported_targets().front().name);
}

}  // namespace
}  // namespace kerf
