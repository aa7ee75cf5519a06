#include "layout/collapse.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "construction/construct.hpp"
#include "support/random_triangles.hpp"
#include "support/targets.hpp"

namespace {

using kerf::BinaryTree;
using kerf::Collapse;
using kerf::CollapseCosts;

BinaryTree tree_of(const kerf_tests::Mesh& mesh) {
  const kerf::TriangleMesh view = mesh.mesh();
  return kerf::construct(kerf::Geometry(std::span(&view, 1)), {.threads = 1});
}

std::uint32_t references_below(const BinaryTree& tree, std::uint32_t node) {
  const kerf::BinaryNode& binary = tree.nodes[node];
  return binary.is_leaf() ? binary.count
                          : references_below(tree, binary.left()) + references_below(tree, binary.right());
}

double area(const BinaryTree& tree, std::uint32_t node) {
  return double{half_area(tree.nodes[node].bounds)};
}

double leaf_cost(const BinaryTree& tree, std::uint32_t node) {
  const CollapseCosts costs;
  return area(tree, node) * (double{costs.leaf} + double{costs.triangle} * references_below(tree, node));
}

// The definition as it stands, in double precision.
struct Oracle {
  const BinaryTree& tree;
  std::uint32_t width;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> known{};

  double distribute(std::uint32_t node, std::uint32_t slots) {
    double min_cost = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 1; k < slots; ++k) {
      min_cost =
          std::min(min_cost, cost(tree.nodes[node].left(), k) + cost(tree.nodes[node].right(), slots - k));
    }
    return min_cost;
  }

  double cost(std::uint32_t node, std::uint32_t slots) {
    if (tree.nodes[node].is_leaf()) return leaf_cost(tree, node);
    if (const auto found = known.find({node, slots}); found != known.end()) return found->second;
    double min_cost;
    if (slots == 1) {
      min_cost = area(tree, node) + distribute(node, width);
      if (references_below(tree, node) <= 8) min_cost = std::min(min_cost, leaf_cost(tree, node));
    } else {
      min_cost = std::min(distribute(node, slots), cost(node, slots - 1));
    }
    return known[{node, slots}] = min_cost;
  }
};

// The cost of the wide tree that the collapse has chosen; checks that every leaf is allowed.
double chosen_cost(const Collapse& collapse, const BinaryTree& tree, std::uint32_t width,
                   std::uint32_t node) {
  const Collapse::Children children = collapse.children(node);
  EXPECT_GE(children.count, 2u);
  EXPECT_LE(children.count, width);
  double cost = area(tree, node);
  for (std::uint32_t i = 0; i < children.count; ++i) {
    const std::uint32_t child = children.node[i];
    if (collapse.is_leaf(child)) {
      EXPECT_LE(references_below(tree, child), 8u);
      EXPECT_EQ(collapse.few_references(child), references_below(tree, child));
      cost += leaf_cost(tree, child);
    } else {
      cost += chosen_cost(collapse, tree, width, child);
    }
  }
  return cost;
}

TEST(Collapse, NoOtherWideTreeIsCheaper) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const BinaryTree tree = tree_of(kerf_tests::random_triangles(40 * seed, 0.3f, 0.1f, seed));
    for (const std::uint32_t width : {16u, 8u, 4u}) {
      Oracle oracle{tree, width};
      const double best = area(tree, 0) + oracle.distribute(0, width);
      EXPECT_NEAR(chosen_cost(Collapse(tree, width), tree, width, 0), best, 1e-5 * best)
          << "seed " << seed << ", width " << width;
    }
  }
}

TEST(Collapse, AnyInstructionSetMakesTheSameChoices) {
  const BinaryTree tree = tree_of(kerf_tests::random_triangles(2000, 0.3f, 0.1f));
  for (const std::uint32_t width : {16u, 8u, 4u}) {
    const Collapse best(tree, width);
    kerf_tests::for_each_target([&](const kerf::Target& target) {
      const Collapse other(tree, width, {}, target);
      for (std::uint32_t node = 0; node < tree.nodes.size(); ++node) {
        const Collapse::Children ours = best.children(node), theirs = other.children(node);
        ASSERT_EQ(ours.count, theirs.count);
        ASSERT_TRUE(std::equal(ours.node.begin(), ours.node.begin() + ours.count, theirs.node.begin()));
        ASSERT_EQ(best.is_leaf(node), other.is_leaf(node));
      }
    });
  }
}

// The layout relies on this where it does not search leaves for duplicate triangles.
TEST(Collapse, NoTriangleStandsTwiceBelowANodeOfFewerReferencesThanTheLeastDivided) {
  kerf_tests::Mesh mesh = kerf_tests::random_triangles(4000, 0.02f, 0.02f);
  const kerf_tests::Mesh large = kerf_tests::random_triangles(40, 1.0f, 1.0f, 2);
  for (const auto& [a, b, c] : large.triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.vertices.insert(mesh.vertices.end(), {large.vertices[a], large.vertices[b], large.vertices[c]});
  }
  const BinaryTree tree = tree_of(mesh);
  ASSERT_GT(tree.min_divided_count, 8u);
  ASSERT_GT(tree.references.size(), mesh.triangles.size()) << "nothing was divided";
  for (const kerf::BinaryNode& root : tree.nodes) {
    std::vector<std::uint32_t> ids;
    const auto gather = [&](const auto& self, const kerf::BinaryNode& node) -> void {
      if (!node.is_leaf()) {
        self(self, tree.nodes[node.left()]);
        self(self, tree.nodes[node.right()]);
      } else {
        ids.insert(ids.end(), tree.references.begin() + node.first,
                   tree.references.begin() + node.first + node.count);
      }
    };
    gather(gather, root);
    if (ids.size() >= tree.min_divided_count) continue;
    std::sort(ids.begin(), ids.end());
    EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
  }
}

}  // namespace
