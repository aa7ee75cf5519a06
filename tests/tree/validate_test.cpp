#include "tree/validate.hpp"

#include <array>

#include <gtest/gtest.h>

#include "construction/construct.hpp"

namespace kerf {
namespace {

// A grid of squares, two triangles each, with hills.
struct Hills {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  Hills() {
    constexpr std::uint32_t n = 9;
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        vertices.push_back(
            {static_cast<float>(x), static_cast<float>(y), 0.1f * static_cast<float>((x * y) % 4)});
        if (x + 1 == n || y + 1 == n) continue;
        const std::uint32_t v = y * n + x;
        triangles.push_back({v, v + 1, v + n});
        triangles.push_back({v + 1, v + n + 1, v + n});
      }
    }
  }
  TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

class Validate : public testing::Test {
 protected:
  Hills hills;
  TriangleMesh mesh = hills.mesh();
  Geometry geometry{{&mesh, 1}};
  BinaryTree tree = construct(geometry, {});

  BinaryNode& first_leaf() {
    return *std::find_if(tree.nodes.begin(), tree.nodes.end(),
                         [](const BinaryNode& n) { return n.is_leaf(); });
  }
  void expect_finding(const std::string& part) {
    const auto findings = validate(tree, geometry);
    ASSERT_FALSE(findings.empty());
    EXPECT_NE(findings[0].find(part), std::string::npos) << findings[0];
  }
};

TEST_F(Validate, FindsNothingInAWholeTree) {
  EXPECT_EQ(validate(tree, geometry), std::vector<std::string>{});
  EXPECT_EQ(validate({}, Geometry({&mesh, 0})), std::vector<std::string>{});
}

TEST_F(Validate, FindsAnEmptyTreeOverTriangles) {
  tree = {};
  expect_finding("triangle 0 is in no leaf");
}

TEST_F(Validate, FindsAChildOutOfItsParent) {
  tree.nodes[1].bounds.upper.z += 1.0f;
  expect_finding("out of its parent");
}

TEST_F(Validate, FindsABoxThatCutsItsTriangleByOneRoundingStep) {
  float& upper = first_leaf().bounds.upper.x;
  upper = std::nextafter(upper, 0.0f);
  expect_finding("has a part in none of its leaves' boxes");
}

TEST_F(Validate, FindsALostTriangle) {
  BinaryNode& leaf = first_leaf();
  tree.references[leaf.first] = tree.references[leaf.first + leaf.count];
  expect_finding("is in no leaf");
}

TEST_F(Validate, FindsATriangleTwiceInALeaf) {
  const BinaryNode& leaf = first_leaf();
  tree.references[leaf.first + 1] = tree.references[leaf.first];
  expect_finding("names a triangle twice");
}

TEST_F(Validate, FindsATriangleThatDoesNotExist) {
  tree.references[first_leaf().first] = 1000;
  expect_finding("does not exist");
}

TEST_F(Validate, FindsAReferenceOfNoLeaf) {
  tree.references.push_back(0);
  expect_finding("is in no leaf");
}

TEST_F(Validate, FindsAnOrphanedNode) {
  tree.nodes.push_back(tree.nodes[1]);
  expect_finding("has no parent");
}

TEST_F(Validate, FindsAChildBeforeItsParent) {
  tree.nodes[1].count = 0;
  tree.nodes[1].first = 1;
  expect_finding("before it or past the end");
}

TEST_F(Validate, FindsALeafThatIsTooDeepOrTooFull) {
  EXPECT_FALSE(validate(tree, geometry, 2).empty());
  EXPECT_FALSE(validate(tree, geometry, 64, 1).empty());
}

}  // namespace
}  // namespace kerf
