#include "support/targets.hpp"

#include <cstdio>
#include <string_view>

#include <gtest/gtest.h>
#include <kerf/error.hpp>

#include "simd/dispatch.hpp"
#include "traversal/dispatch.hpp"

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

// Newer versions of Highway know more than these, which would make the library twice as large for nothing.
std::size_t expected_lanes(std::string_view target) {
  if (target == "AVX3") return 16;
  if (target == "AVX2") return 8;
  if (target == "SSE4" || target.starts_with("NEON")) return 4;
  return target == "SCALAR" ? 1 : 0;
}

TEST(Targets, AreThoseThatKernelsGainFromWithAllOfTheirLanes) {
  kerf_tests::for_each_target([](const Target& target) {
    const Kernels& kernels = choose_kernels();
    std::printf("%-16s %2zu lanes\n", kernels.target, kernels.float_lanes);
    EXPECT_STREQ(kernels.target, target.name);
    EXPECT_EQ(kernels.float_lanes, expected_lanes(target.name)) << target.name;
  });
}

TEST(Targets, AreChosenByTheEnvironment) {
  const auto chosen = [](const char* name) {
    const kerf_tests::ChosenTarget named(name);
    return std::string_view(choose_target().name);
  };
  for (const Target& target : supported_targets()) EXPECT_EQ(chosen(target.name), target.name);
  EXPECT_EQ(chosen(""), supported_targets().front().name);
}

TEST(Targets, AnUnknownNameIsRefusedWithThoseThereAre) {
  const kerf_tests::ChosenTarget named("AVX9");
  try {
    choose_target();
    FAIL() << "it fell to another target without a word";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::invalid_argument);
    EXPECT_NE(std::string_view(error.what()).find("KERF_TARGET is \"AVX9\""), std::string_view::npos);
    EXPECT_TRUE(std::string_view(error.what()).ends_with("SCALAR")) << error.what();
  }
}

}  // namespace
}  // namespace kerf
