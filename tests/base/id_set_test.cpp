#include "base/id_set.hpp"

#include <random>
#include <unordered_set>

#include <gtest/gtest.h>

namespace kerf {
namespace {

TEST(IdSet, TakesEachNumberOnceAsTheStandardSetDoes) {
  std::mt19937 random(1);
  for (const std::uint32_t range : {4u, 40u, 1000u, 0xffffffffu}) {
    IdSet set;
    std::unordered_set<std::uint32_t> expected;
    for (int i = 0; i < 5000; ++i) {
      const std::uint32_t id = static_cast<std::uint32_t>(random() % range);
      ASSERT_EQ(set.insert(id), expected.insert(id).second);
      ASSERT_EQ(set.size(), expected.size());
    }
  }
}

}  // namespace
}  // namespace kerf
