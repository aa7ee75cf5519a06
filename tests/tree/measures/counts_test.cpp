#include "tree/measures/counts.hpp"

#include <gtest/gtest.h>

#include "construction/construct.hpp"
#include "tree/measures/sample_trees.hpp"

namespace kerf {
namespace {

TEST(Counts, AddUp) {
  const Soup soup = random_soup(1000, 0.1f, 4);
  const TriangleMesh mesh = soup.mesh();
  const BinaryTree tree = construct(Geometry({&mesh, 1}), {});
  const TreeCounts counts = count_tree(tree);
  std::size_t leaves = 0, references = 0;
  for (std::size_t k = 0; k < counts.leaf_sizes.size(); ++k) {
    leaves += counts.leaf_sizes[k];
    references += k * counts.leaf_sizes[k];
  }
  EXPECT_EQ(leaves, counts.leaves);
  EXPECT_EQ(references, counts.references);
  EXPECT_EQ(counts.nodes, 2 * counts.leaves - 1);
  EXPECT_GE(std::size_t{1} << counts.depth, counts.leaves);
}

}  // namespace
}  // namespace kerf
