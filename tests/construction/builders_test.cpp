#include "construction/builders.hpp"

#include <set>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "support/random_triangles.hpp"
#include "tree/validate.hpp"

namespace kerf {
namespace {

TEST(Builders, HaveNamesOfTheirOwnAndAMeaning) {
  std::set<std::string_view> names;
  std::set<Builder> seen;
  for (const BuilderInfo& info : builders()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_TRUE(seen.insert(info.builder).second) << info.name;
    EXPECT_FALSE(info.meaning.empty()) << info.name;
  }
  EXPECT_TRUE(seen.count(BuildOptions().builder));
}

TEST(Builders, EachBuildsAWholeTree) {
  const kerf_tests::Mesh mesh = kerf_tests::random_triangles(500, 0.5f, 0.01f);
  const TriangleMesh view = mesh.mesh();
  const Geometry geometry({&view, 1});
  for (const BuilderInfo& info : builders()) {
    const BuilderEntry* const entry = find_builder(info.builder);
    ASSERT_NE(entry, nullptr);
    EXPECT_EQ(entry->info.name, info.name);
    EXPECT_EQ(validate(entry->construct(geometry, {.builder = info.builder}), geometry, max_tree_depth),
              std::vector<std::string>{})
        << info.name;
  }
}

TEST(Builders, AnUnknownOneHasNoEntry) {
  EXPECT_EQ(find_builder(static_cast<Builder>(99)), nullptr);
}

}  // namespace
}  // namespace kerf
