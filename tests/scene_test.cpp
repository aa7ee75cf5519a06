#include "workbench/scene.hpp"

#include <gtest/gtest.h>

#include "workbench/generated_scenes.hpp"

namespace workbench {
namespace {

TEST(GeneratedScenes, HaveTheTriangleCountsThatAreListed) {
  for (const GeneratedScene& generated : generated_scenes()) {
    SCOPED_TRACE(generated.name);
    const Scene scene = generated.generate(1.0);
    EXPECT_EQ(scene.triangles.size(), generated.default_triangles);
    EXPECT_GE(scene.triangles.size(), 50'000u);
    EXPECT_LE(scene.triangles.size(), 300'000u);
    EXPECT_GE(scene.viewpoints.size(), 3u);
  }
}

}  // namespace
}  // namespace workbench
