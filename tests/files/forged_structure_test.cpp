// Each check of `check_structure`, by a file in which just that is wrong and whose checksums are right.
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "fuzz/forged_file.hpp"
#include "layout/wide_bvh.hpp"
#include "support/temporary_directory.hpp"
#include "tree/binary_tree.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

// A .kerf file in its parts.
struct Parts {
  FileHeader header;
  std::vector<std::uint32_t> first_triangles;
  std::vector<WideNode> nodes;
  std::vector<std::uint32_t> leaves;

  explicit Parts(const Bvh& bvh)
      : header(make_header(bvh.structure())),
        first_triangles(bvh.structure().first_triangles),
        nodes(bvh.structure().wide.nodes.begin(), bvh.structure().wide.nodes.end()),
        leaves(bvh.structure().wide.leaves.begin(), bvh.structure().wide.leaves.end()) {}

  // What loading the parts as a file comes to.
  std::string verdict() {
    header.meshes = static_cast<std::uint32_t>(first_triangles.size() - 1);
    header.nodes = static_cast<std::uint32_t>(nodes.size());
    header.leaf_words = leaves.size();
    const FileLayout layout(header);
    header.file_bytes = layout.file_bytes;
    std::vector<std::byte> image(layout.file_bytes);
    const auto put = [&](std::uint64_t at, std::span<const std::byte> bytes) {
      std::copy(bytes.begin(), bytes.end(), image.begin() + static_cast<std::ptrdiff_t>(at));
    };
    put(0, std::as_bytes(std::span(&header, 1)));
    put(layout.meshes_at, std::as_bytes(std::span(first_triangles)));
    put(layout.nodes_at, std::as_bytes(std::span(nodes)));
    put(layout.leaves_at, std::as_bytes(std::span(leaves)));
    forged::sign(image);
    try {
      forged::query(forged::load(image));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::bad_format);
      return error.what();
    }
    return "answers";
  }
};

// The first slot of a node that has another node, or a leaf.
std::uint32_t slot_of(const WideNode& node, bool leaf) {
  std::uint32_t slot = 0;
  while (node.children[slot].is_leaf() != leaf) ++slot;
  return slot;
}

// A hierarchy with nodes below nodes, and one of a single node, most of whose slots are unused.
Bvh large() {
  return build(workbench::make_sphere(4).mesh());
}
Bvh small() {
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 1};
  return build({.vertices = vertices, .triangles = indices});
}

void expect_refused(const Bvh& bvh, const std::string& sentence, const std::function<void(Parts&)>& forge) {
  Parts parts(bvh);
  ASSERT_EQ(parts.verdict(), "answers");
  forge(parts);
  EXPECT_EQ(parts.verdict().substr(0, sentence.size()), sentence);
}

const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

TEST(ForgedStructure, NodesThatAreNoTreeAreRefused) {
  const Bvh bvh = large();
  expect_refused(bvh, "a second link to a node", [](Parts& parts) {
    const std::uint32_t slot = slot_of(parts.nodes[0], false);
    parts.nodes[0].children[slot + 1] = parts.nodes[0].children[slot];
  });
  expect_refused(bvh, "a node that no other leads to", [](Parts& parts) {
    const WideNode& last = parts.nodes.back();
    parts.nodes[0].children[slot_of(parts.nodes[0], false)] = last.children[slot_of(last, true)];
  });
  expect_refused(bvh, "a link to an impossible node", [](Parts& parts) {
    parts.nodes[0].children[slot_of(parts.nodes[0], false)] = ChildLink::node(0);
  });
  expect_refused(bvh, "a link to an impossible node", [](Parts& parts) {
    const auto nodes = static_cast<std::uint32_t>(parts.nodes.size());
    parts.nodes[0].children[slot_of(parts.nodes[0], false)] = ChildLink::node(nodes);
  });
  expect_refused(bvh, "the hierarchy has another depth", [](Parts& parts) { --parts.header.depth; });
}

// Traversals have room for so many nodes one below another, and for no more.
TEST(ForgedStructure, AChainOfNodesIsRefusedWhereItIsTooDeep) {
  for (const std::uint32_t depth : {max_tree_depth, max_tree_depth + 1, 254u, 300u}) {
    Parts parts(small());
    parts.nodes.resize(depth, WideNode(parts.nodes[0]));
    for (std::uint32_t i = 0; i + 1 < parts.nodes.size(); ++i)
      parts.nodes[i].children[0] = ChildLink::node(i + 1);
    parts.header.depth = depth;
    EXPECT_EQ(parts.verdict(),
              depth == max_tree_depth ? "answers" : "a node too deep for any traversal (96)");
  }
}

TEST(ForgedStructure, UnusedSlotsThatLeadSomewhereElseAreRefused) {
  expect_refused(small(), "an unused slot that names a node",
                 [](Parts& parts) { parts.nodes[0].children[15] = ChildLink::node(0); });
  expect_refused(small(), "a leaf outside the triangles", [](Parts& parts) {
    parts.nodes[0].children[15] = ChildLink::leaf(ChildLink::max_place, 8);
  });
}

TEST(ForgedStructure, LeavesThatAreNotThereAreRefused) {
  expect_refused(small(), "a leaf outside the triangles", [](Parts& parts) {
    parts.nodes[0].children[0] = ChildLink::leaf(0, parts.nodes[0].children[0].count() + 1);
  });
  expect_refused(small(), "leaf data of an impossible size",
                 [](Parts& parts) { parts.leaves.resize(leaf_padding_words); });
  expect_refused(small(), "leaf data of an impossible size",
                 [](Parts& parts) { parts.leaves.resize(words_per_triangle + leaf_padding_words - 1); });
  expect_refused(small(), "leaf data of an impossible size", [](Parts& parts) { parts.leaves.push_back(0); });
}

TEST(ForgedStructure, TrianglesThatCannotBeAreRefused) {
  for (const float bad : {infinity, -infinity, nan}) {
    for (std::size_t word = 0; word < 18; ++word) {
      expect_refused(small(), "a triangle that is not finite",
                     [&](Parts& parts) { parts.leaves[word] = std::bit_cast<std::uint32_t>(bad); });
    }
  }
  expect_refused(small(), "a triangle that no mesh has", [](Parts& parts) { parts.leaves[18] = 2; });
}

TEST(ForgedStructure, BoxesThatCannotBeAreRefused) {
  for (const float bad : {infinity, -infinity, nan, 1e30f}) {
    for (int axis = 0; axis < 3; ++axis) {
      expect_refused(small(), "a node with an impossible box",
                     [&](Parts& parts) { parts.nodes[0].planes[axis][0][0] = bad; });
      expect_refused(small(), "a node with an impossible box",
                     [&](Parts& parts) { parts.nodes[0].planes[axis][1][0] = -bad; });
      expect_refused(small(), "impossible bounds",
                     [&](Parts& parts) { parts.header.bounds.lower[axis] = bad; });
      expect_refused(small(), "impossible bounds",
                     [&](Parts& parts) { parts.header.bounds.upper[axis] = -bad; });
    }
  }
}

TEST(ForgedStructure, AHierarchyOfNothingThatHasSomethingIsRefused) {
  const Bvh nothing = build(TriangleMesh{});
  expect_refused(small(), "triangles without nodes", [](Parts& parts) {
    parts.nodes.clear();
    parts.header.depth = 0;
    parts.header.bounds = {};
  });
  expect_refused(nothing, "triangles without nodes", [](Parts& parts) { parts.header.depth = 1; });
  expect_refused(nothing, "triangles without nodes", [](Parts& parts) {
    parts.header.bounds = {{0, 0, 0}, {1, 1, 1}};
  });
}

TEST(ForgedStructure, MeshesThatDoNotAddUpAreRefused) {
  const char* out_of_order = "the meshes are out of order";
  const char* other_number = "the meshes have another number of triangles";
  expect_refused(small(), out_of_order, [](Parts& parts) { parts.first_triangles[0] = 1; });
  expect_refused(small(), out_of_order, [](Parts& parts) { parts.first_triangles = {0, 2, 1, 2}; });
  expect_refused(small(), other_number, [](Parts& parts) { parts.first_triangles.back() = 3; });
  expect_refused(small(), other_number, [](Parts& parts) {
    parts.first_triangles.back() = 1u << 31;
    parts.header.triangles = 1u << 31;
  });
  expect_refused(small(), other_number, [](Parts& parts) { parts.header.degenerate_triangles = 3; });
}

}  // namespace
}  // namespace kerf
