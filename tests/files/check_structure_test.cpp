// For each check of `check_structure` a file that only this check refuses: everything else in it is right,
// also its checksums.
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "fuzz/forged_file.hpp"
#include "layout/wide_bvh.hpp"
#include "support/node_width.hpp"
#include "support/temporary_directory.hpp"
#include "tree/binary_tree.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using Node = WideNode<16>;

// A .kerf file in its sections, with nodes of sixteen children whatever the machine traces.
struct Sections {
  FileHeader header;
  std::vector<std::uint32_t> first_triangles;
  std::vector<Node> nodes;
  std::vector<std::uint32_t> leaves;

  explicit Sections(const Bvh& any_width) {
    const Bvh bvh = kerf_tests::with_node_width(any_width, Node::width);
    const Structure& structure = Structure::of(bvh);
    const WideBvh& wide = structure.wide;
    header = make_header(structure);
    first_triangles = structure.first_triangles;
    nodes.assign(wide.nodes<Node>(), wide.nodes<Node>() + wide.node_count);
    leaves.assign(wide.leaves.begin(), wide.leaves.end());
  }

  // Loads the sections as a file. Returns the sentence of the error, or "answers".
  std::string verdict() {
    header.meshes = static_cast<std::uint32_t>(first_triangles.size() - 1);
    header.nodes = static_cast<std::uint32_t>(nodes.size());
    header.leaf_words = leaves.size();
    header.file_bytes = 0;  // without an annex
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

// The first slot of a node that links to a leaf, or the first that links to a node.
std::uint32_t slot_of(const Node& node, bool leaf) {
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

void expect_refused(const Bvh& bvh, const std::string& sentence,
                    const std::function<void(Sections&)>& forge) {
  Sections sections(bvh);
  ASSERT_EQ(sections.verdict(), "answers");
  forge(sections);
  EXPECT_EQ(sections.verdict().substr(0, sentence.size()), sentence);
}

const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

TEST(CheckStructure, NodesThatAreNoTreeAreRefused) {
  const Bvh bvh = large();
  expect_refused(bvh, "a second link to a node", [](Sections& sections) {
    const std::uint32_t slot = slot_of(sections.nodes[0], false);
    sections.nodes[0].children[slot + 1] = sections.nodes[0].children[slot];
  });
  expect_refused(bvh, "a node that no other leads to", [](Sections& sections) {
    const Node& last = sections.nodes.back();
    sections.nodes[0].children[slot_of(sections.nodes[0], false)] = last.children[slot_of(last, true)];
  });
  expect_refused(bvh, "a link to an impossible node", [](Sections& sections) {
    sections.nodes[0].children[slot_of(sections.nodes[0], false)] = ChildLink::node(0);
  });
  expect_refused(bvh, "a link to an impossible node", [](Sections& sections) {
    const auto nodes = static_cast<std::uint32_t>(sections.nodes.size());
    sections.nodes[0].children[slot_of(sections.nodes[0], false)] = ChildLink::node(nodes);
  });
  expect_refused(bvh, "the hierarchy has another depth", [](Sections& sections) { --sections.header.depth; });
}

// The stacks of traversals have room for this depth.
TEST(CheckStructure, AChainOfNodesIsRefusedWhereItIsTooDeep) {
  for (const std::uint32_t depth : {max_tree_depth, max_tree_depth + 1, 254u, 300u}) {
    Sections sections(small());
    sections.nodes.resize(depth, Node(sections.nodes[0]));
    for (std::uint32_t i = 0; i + 1 < sections.nodes.size(); ++i)
      sections.nodes[i].children[0] = ChildLink::node(i + 1);
    sections.header.depth = depth;
    EXPECT_EQ(sections.verdict(),
              depth == max_tree_depth ? "answers" : "a node too deep for any traversal (96)");
  }
}

TEST(CheckStructure, UnusedSlotsThatLeadSomewhereElseAreRefused) {
  expect_refused(small(), "an unused slot that names a node",
                 [](Sections& sections) { sections.nodes[0].children[15] = ChildLink::node(0); });
  expect_refused(small(), "a leaf outside the triangles", [](Sections& sections) {
    sections.nodes[0].children[15] = ChildLink::leaf(ChildLink::max_place, 8);
  });
}

TEST(CheckStructure, LeavesThatAreNotThereAreRefused) {
  expect_refused(small(), "a leaf outside the triangles", [](Sections& sections) {
    sections.nodes[0].children[0] = ChildLink::leaf(0, sections.nodes[0].children[0].count() + 1);
  });
  expect_refused(small(), "leaf data of an impossible size",
                 [](Sections& sections) { sections.leaves.resize(leaf_padding_words); });
  expect_refused(small(), "leaf data of an impossible size", [](Sections& sections) {
    sections.leaves.resize(words_per_triangle + leaf_padding_words - 1);
  });
  expect_refused(small(), "leaf data of an impossible size",
                 [](Sections& sections) { sections.leaves.push_back(0); });
}

TEST(CheckStructure, TrianglesThatCannotBeAreRefused) {
  for (const float bad : {infinity, -infinity, nan}) {
    for (std::size_t word = 0; word < 18; ++word) {
      expect_refused(small(), "a triangle that is not finite",
                     [&](Sections& sections) { sections.leaves[word] = std::bit_cast<std::uint32_t>(bad); });
    }
  }
  expect_refused(small(), "a triangle that no mesh has", [](Sections& sections) { sections.leaves[18] = 2; });
}

TEST(CheckStructure, BoxesThatCannotBeAreRefused) {
  for (const float bad : {infinity, -infinity, nan, 1e30f}) {
    for (int axis = 0; axis < 3; ++axis) {
      expect_refused(small(), "a node with an impossible box",
                     [&](Sections& sections) { sections.nodes[0].planes[axis][0][0] = bad; });
      expect_refused(small(), "a node with an impossible box",
                     [&](Sections& sections) { sections.nodes[0].planes[axis][1][0] = -bad; });
      expect_refused(small(), "impossible bounds",
                     [&](Sections& sections) { sections.header.bounds.lower[axis] = bad; });
      expect_refused(small(), "impossible bounds",
                     [&](Sections& sections) { sections.header.bounds.upper[axis] = -bad; });
    }
  }
}

TEST(CheckStructure, AHierarchyOfNothingThatHasSomethingIsRefused) {
  const Bvh nothing = build(TriangleMesh{});
  expect_refused(small(), "triangles without nodes", [](Sections& sections) {
    sections.nodes.clear();
    sections.header.depth = 0;
    sections.header.bounds = {};
  });
  expect_refused(nothing, "triangles without nodes", [](Sections& sections) { sections.header.depth = 1; });
  expect_refused(nothing, "triangles without nodes", [](Sections& sections) {
    sections.header.bounds = {{0, 0, 0}, {1, 1, 1}};
  });
}

TEST(CheckStructure, MeshesThatDoNotAddUpAreRefused) {
  const char* out_of_order = "the meshes are out of order";
  const char* other_number = "the meshes have another number of triangles";
  expect_refused(small(), out_of_order, [](Sections& sections) { sections.first_triangles[0] = 1; });
  expect_refused(small(), out_of_order, [](Sections& sections) { sections.first_triangles = {0, 2, 1, 2}; });
  expect_refused(small(), other_number, [](Sections& sections) { sections.first_triangles.back() = 3; });
  expect_refused(small(), other_number, [](Sections& sections) {
    sections.first_triangles.back() = 1u << 31;
    sections.header.triangles = 1u << 31;
  });
  expect_refused(small(), other_number, [](Sections& sections) { sections.header.degenerate_triangles = 3; });
}

}  // namespace
}  // namespace kerf
