#include "refinement/movable_tree.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>

#include "construction/construct.hpp"
#include "support/random_triangles.hpp"
#include "tree/validate.hpp"

namespace kerf {
namespace {

class MovableTrees : public testing::Test {
 protected:
  const kerf_tests::Mesh mesh_ = kerf_tests::random_triangles(400, 0.5f, 0.02f);
  const TriangleMesh view_ = mesh_.mesh();
  const Geometry geometry_{{&view_, 1}};
  BinaryTree tree_ = construct(geometry_, {.max_leaf_size = 2});

  void expect_consistent(const MovableTree& movable) {
    for (std::uint32_t n = 0; n < movable.node_count(); ++n) {
      const BinaryNode& node = movable.node(n);
      if (node.is_leaf()) {
        ASSERT_EQ(movable.references(n), node.count);
        continue;
      }
      ASSERT_EQ(movable.parent(node.left()), n);
      ASSERT_EQ(movable.parent(node.right()), n);
      ASSERT_EQ(movable.sibling(node.left()), node.right());
      ASSERT_EQ(movable.references(n), movable.references(node.left()) + movable.references(node.right()));
      ASSERT_EQ(node.bounds, merge(movable.box(node.left()), movable.box(node.right())));
    }
  }
};

TEST_F(MovableTrees, AnyMovesLeaveAValidTree) {
  MovableTree movable(tree_);
  std::mt19937 random(1);
  std::uniform_int_distribution<std::uint32_t> any(0, movable.node_count() - 1);
  std::size_t moved = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t n = any(random), target = any(random);
    if (!movable.can_move(n, target)) continue;
    movable.move(n, target);
    ++moved;
  }
  EXPECT_GT(moved, 1000u);
  expect_consistent(movable);
  number_depth_first(tree_);
  EXPECT_EQ(validate(tree_, geometry_, max_tree_depth), std::vector<std::string>{});
}

TEST_F(MovableTrees, AMoveIsUndoneByTheMoveBack) {
  MovableTree movable(tree_);
  std::mt19937 random(2);
  std::uniform_int_distribution<std::uint32_t> any(0, movable.node_count() - 1);
  // Siblings may have changed sides, which the sum over nodes does not see.
  const auto state = [&] {
    std::vector<std::pair<std::uint32_t, float>> all;
    for (std::uint32_t n = 0; n < movable.node_count(); ++n)
      all.emplace_back(movable.references(n), half_area(movable.box(n)));
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto before = state();
  for (int i = 0; i < 500; ++i) {
    const std::uint32_t n = any(random), target = any(random);
    if (!movable.can_move(n, target)) continue;
    const std::uint32_t place = movable.move(n, target);
    movable.move(movable.node(target).right(), place);
  }
  EXPECT_EQ(state(), before);
  expect_consistent(movable);
}

TEST_F(MovableTrees, NothingMovesIntoItselfOrFromTheRoot) {
  const MovableTree movable(tree_);
  const BinaryNode& root = movable.node(0);
  const std::uint32_t inner = movable.node(root.left()).left(), other = movable.sibling(inner);
  EXPECT_FALSE(movable.can_move(0, inner));
  EXPECT_FALSE(movable.can_move(root.left(), inner)) << "the root would have one child";
  EXPECT_FALSE(movable.can_move(inner, 0));
  EXPECT_FALSE(movable.can_move(inner, inner));
  EXPECT_FALSE(movable.can_move(inner, other)) << "it is there already";
  EXPECT_FALSE(movable.can_move(inner, root.left())) << "it is there already";
  EXPECT_TRUE(movable.can_move(inner, root.right()));
}

// A tree that is a chain is as deep as trees may be.
TEST(MovableTree, NoMoveMakesTheTreeTooDeep) {
  BinaryTree tree;
  const Box3f box{{0, 0, 0}, {1, 1, 1}};
  tree.nodes.resize(2 * max_tree_depth + 1);
  tree.references.resize(max_tree_depth + 1);
  for (std::uint32_t depth = 0; depth < max_tree_depth; ++depth) {
    const std::uint32_t inner = depth == 0 ? 0 : 2 * depth;
    tree.nodes[inner] = {box, 2 * depth + 1, 0};
    tree.nodes[2 * depth + 1] = {box, depth, 1};
    tree.references[depth] = depth;
  }
  tree.nodes[2 * max_tree_depth] = {box, max_tree_depth, 1};
  const MovableTree movable(tree);
  EXPECT_FALSE(movable.can_move(3, 2 * max_tree_depth)) << "below the deepest leaf";
  EXPECT_FALSE(movable.can_move(5, 4)) << "it is there already";
  EXPECT_TRUE(movable.can_move(2 * max_tree_depth, 3)) << "upwards";
}

}  // namespace
}  // namespace kerf
