#include "construction/presplit/merge_parts.hpp"

#include <gtest/gtest.h>

namespace kerf {
namespace {

TEST(MergeParts, KeepsEachTriangleOncePerLeaf) {
  BinaryTree tree{.nodes = {{{{0, 0, 0}, {1, 1, 1}}, 1, 0},
                            {{{0, 0, 0}, {1, 1, 1}}, 0, 4},
                            {{{0, 0, 0}, {1, 1, 1}}, 4, 2}},
                  .references = {3, 1, 3, 3, 1, 3}};
  merge_parts_in_leaves(tree);
  EXPECT_EQ(tree.references, (UninitializedVector<std::uint32_t>{3, 1, 1, 3}));
  EXPECT_EQ(tree.nodes[1].count, 2u);
  EXPECT_EQ(tree.nodes[2].first, 2u);
  EXPECT_EQ(tree.nodes[2].count, 2u);
}

}  // namespace
}  // namespace kerf
