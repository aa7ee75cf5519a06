#include "workbench/bench/peer_isa.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "workbench/bench/peers/embree.hpp"
#include "workbench/open/load_scene.hpp"

namespace workbench {
namespace {

TEST(PeerIsa, IsNeverAboveTheTargetOfKerf) {
  using List = std::vector<std::string>;
  const List all{"sse2", "sse4.2", "avx", "avx2", "avx512"};
  for (const char* target : {"AVX3", "AVX3_DL", "AVX3_ZEN4", "AVX3_SPR", "AVX10_2"}) {
    EXPECT_EQ(isas_up_to(target, all), all) << target;
  }
  EXPECT_EQ(isas_up_to("AVX2", all), (List{"sse2", "sse4.2", "avx", "avx2"}));
  EXPECT_EQ(isas_up_to("SSE4", all), (List{"sse2", "sse4.2"}));
  EXPECT_EQ(isas_up_to("SSE2", all), List{"sse2"});
  EXPECT_EQ(isas_up_to("SCALAR", all), List{"sse2"});  // below which Embree does not go
}

TEST(PeerIsa, WithoutAChoiceIsTheOnlyOne) {
  const std::vector<std::string> native{"native"};
  EXPECT_EQ(isas_up_to("NEON", native), native);
  EXPECT_EQ(fastest_isa(load_scene("terrain:detail=0.002"), native, {}), "native");
}

TEST(PeerIsa, OfTheFastestIsOneOfThoseMeasuredAndTheEnginesHaveIt) {
  const std::vector<std::string> isas = embree_isas();
  if (isas.empty()) GTEST_SKIP() << "built without Embree";
  BenchOptions options;
  options.trace_rounds = 1;
  options.rays = {.width = 32, .height = 24};
  const std::string fastest = fastest_isa(load_scene("terrain:detail=0.002"), isas, options);
  EXPECT_NE(std::find(isas.begin(), isas.end(), fastest), isas.end()) << fastest;
  for (const Engine& engine : embree_engines(1, fastest)) EXPECT_EQ(engine.isa, fastest);
}

}  // namespace
}  // namespace workbench
