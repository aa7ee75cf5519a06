#include "construction/sbvh/parallel_build.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "base/scratch_pool.hpp"
#include "base/uninitialized.hpp"
#include "construction/input.hpp"
#include "construction/progress.hpp"
#include "construction/sbvh/finished_subtree.hpp"
#include "construction/sbvh/subtree.hpp"

namespace kerf {
namespace {

// A node with room for at most this many references becomes one task, which builds the whole subtree. What
// the task writes stays in the second-level cache, and there are few enough tasks that scheduling them costs
// next to nothing.
constexpr std::uint32_t task_capacity = 4096;

// Where a task builds a subtree of at most `capacity` references before it is stored. A subtree of n
// references has at most 2n - 1 nodes. Not initialised: that would take longer than the build of a small
// mesh.
struct Scratch {
  UninitializedVector<BinaryNode> nodes;
  UninitializedVector<std::uint32_t> references;

  explicit Scratch(std::size_t capacity) : nodes(2 * capacity), references(capacity) {}

  static constexpr std::size_t bytes(std::size_t capacity) {
    return capacity * (2 * sizeof(BinaryNode) + sizeof(std::uint32_t));
  }
};

// The most references that a task builds from, in a build with room for so many.
std::size_t scratch_capacity(std::size_t references) {
  return std::min<std::size_t>(references, task_capacity);
}

// A node above the tasks, or the subtree that one task built.
struct TopNode {
  Box3f box;
  std::unique_ptr<TopNode> left, right;  // null for a subtree
  SubtreeSize size{};                    // of a subtree
  FinishedSubtree subtree;
};

class ParallelBuilder {
 public:
  // For at most `references` references, of which there are `count` to begin with.
  ParallelBuilder(const BuildContext& context, const BuildOptions& options, std::uint32_t count,
                  std::size_t references)
      : context_(context),
        progress_(options.progress, count),
        scratch_capacity_(scratch_capacity(references)) {}

  BinaryTree build(const NodeInput& root, std::size_t arena_bytes) {
    TopNode top;
    std::size_t scratch_bytes;
    {
      ScratchPool<Scratch> scratch;
      build_below(top, root, scratch);
      scratch_bytes = scratch.size() * Scratch::bytes(scratch_capacity_);
    }
    BinaryTree tree;
    const std::size_t assembly_bytes = assemble(top, tree);
    tree.build_peak_bytes = arena_bytes + spilled_bytes_ + top_nodes_ * bytes_per_top_node +
                            std::max(scratch_bytes, tree.bytes() + assembly_bytes);
    return tree;
  }

 private:
  void build_below(TopNode& top, const NodeInput& node, ScratchPool<Scratch>& scratch) {
    progress_.check();
    top.box = node.box;
    NodeInput left, right;
    if (node.range.capacity() <= task_capacity || !split_node(context_, node, left, right)) {
      return build_in_one_task(top, node, scratch);
    }
    top.left = std::make_unique<TopNode>();
    top.right = std::make_unique<TopNode>();
    top_nodes_ += 2;
    parallel_invoke([&] { build_below(*top.left, left, scratch); },
                    [&] { build_below(*top.right, right, scratch); });
  }

  // The subtree overwrites the references that it was built from: nothing reads these any more.
  void build_in_one_task(TopNode& top, const NodeInput& node, ScratchPool<Scratch>& pool) {
    const auto scratch = pool.borrow([this] { return Scratch(scratch_capacity_); });
    top.size = build_subtree(context_, node, scratch->nodes.data(), scratch->references.data());
    top.subtree = FinishedSubtree(top.size, scratch->nodes.data(), scratch->references.data(),
                                  context_.arena + node.range.begin, node.range.capacity());
    spilled_bytes_ += top.subtree.spilled_bytes();
    progress_.add(node.range.count());
  }

  // Where a subtree goes in the tree: the slot of its root, which stands beside its sibling, and the first
  // slots of its other nodes and of its references.
  struct SubtreePlace {
    const TopNode* top;
    std::uint32_t root, nodes, references;
  };
  // A node above the tasks and its slot in the tree.
  struct InnerPlace {
    std::uint32_t slot;
    BinaryNode node;
  };
  // The places of all, and how many nodes and references have theirs so far.
  struct Places {
    std::vector<SubtreePlace> subtrees;
    std::vector<InnerPlace> inner;
    std::uint32_t nodes = 1, references = 0;
  };

  // Returns the bytes that were held meanwhile beside the top nodes and the tree.
  std::size_t assemble(const TopNode& top, BinaryTree& tree) {
    Places places;
    places.subtrees.reserve(top_nodes_ / 2 + 1);
    places.inner.reserve(top_nodes_ / 2);
    assign_places(top, 0, places);
    tree.nodes.resize(places.nodes);
    tree.references.resize(places.references);
    parallel_for(places.subtrees.size(), [&](std::size_t i) { copy(places.subtrees[i], tree); });
    for (const auto& [slot, node] : places.inner) tree.nodes[slot] = node;
    return places.subtrees.capacity() * sizeof(SubtreePlace) + places.inner.capacity() * sizeof(InnerPlace);
  }

  // The order is that of a depth-first build on one thread, so that the tree is the same for any number of
  // threads.
  static void assign_places(const TopNode& top, std::uint32_t slot, Places& places) {
    if (top.left == nullptr) {
      places.subtrees.push_back({&top, slot, places.nodes, places.references});
      places.nodes += top.size.nodes - 1;
      places.references += top.size.references;
      return;
    }
    const std::uint32_t child = places.nodes;
    places.inner.push_back({slot, {.bounds = top.box, .first = child, .count = 0}});
    places.nodes += 2;
    assign_places(*top.left, child, places);
    assign_places(*top.right, child + 1, places);
  }

  static void copy(const SubtreePlace& place, BinaryTree& tree) {
    const TopNode& top = *place.top;
    for (std::uint32_t i = 0; i < top.size.nodes; ++i) {
      BinaryNode& node = tree.nodes[i == 0 ? place.root : place.nodes + i - 1];
      top.subtree.read_node(i, node);
      node.first += node.is_leaf() ? place.references : place.nodes - 1;
    }
    top.subtree.read_references(top.size, tree.references.data() + place.references);
  }

 public:
  // What is held per top node: the node with the overhead of its allocation, and its place.
  static constexpr std::size_t bytes_per_top_node = sizeof(TopNode) + 2 * sizeof(void*);
  static constexpr std::size_t bytes_per_place = std::max(sizeof(SubtreePlace), sizeof(InnerPlace));

 private:
  const BuildContext& context_;
  Progress progress_;
  const std::size_t scratch_capacity_;
  std::atomic<std::size_t> spilled_bytes_ = 0, top_nodes_ = 0;
};

// Spatial splits are tried in nodes of at least this many references whose children overlap by at least this
// fraction of their own area. Others are rarely found and gain little: leaving them out costs 0.1 % of the
// surface-area cost on sponza and saves half the time (docs/decisions/0011, 0012). With an alpha of 0, all
// are tried.
constexpr std::uint32_t min_spatial_count = 96;
constexpr float min_relative_overlap = 0.05f;

bool splits_space(const BuildOptions& options) {
  return options.builder == Builder::sbvh && options.alpha < 1.0f;
}

}  // namespace

std::size_t max_references(std::size_t triangles, const BuildOptions& options) {
  const double ratio = splits_space(options) ? double{options.max_reference_ratio} : 1.0;
  return static_cast<std::size_t>(static_cast<double>(triangles) * ratio);
}

BinaryTree construct_split_tree(const Geometry& geometry, const BuildOptions& options) {
  if (geometry.triangle_count() == 0) return {};
  const std::size_t room = max_references(geometry.triangle_count(), options);
  if (room >= (std::size_t{1} << 31)) {
    raise(Error::too_large, "there may be 2^31 references or more, which is more than kerf can number");
  }
  UninitializedVector<Reference> arena(room);
  return on_threads(options.threads, [&]() -> BinaryTree {
    const ReferenceSummary input = write_references(geometry, options.non_finite, arena.data());
    BinaryTree tree;
    if (input.count != 0) {
      const float root_area = half_area(input.box);
      // Chopping could overflow where the area overflows: see math/clip.hpp.
      const bool can_chop = splits_space(options) && std::isfinite(root_area);
      const BuildContext context{.geometry = can_chop ? &geometry : nullptr,
                                 .arena = arena.data(),
                                 .max_leaf_size = options.max_leaf_size,
                                 .absolute_overlap = options.alpha * root_area,
                                 .relative_overlap = options.alpha > 0.0f ? min_relative_overlap : 0.0f,
                                 .min_spatial_count = options.alpha > 0.0f ? min_spatial_count : 2};
      const auto limit = static_cast<std::uint32_t>(max_references(input.count, options));
      tree = ParallelBuilder(context, options, input.count, limit)
                 .build({{0, input.count, limit}, 0, input.box, input.doubled_centroids},
                        room * sizeof(Reference));
      tree.min_divided_count = context.geometry == nullptr ? ~std::uint32_t{0} : context.min_spatial_count;
    }
    tree.degenerate_triangles = input.degenerate_triangles;
    tree.non_finite_triangles = input.non_finite_triangles;
    return tree;
  });
}

BinaryTree construct_object_split_tree(std::vector<Reference> references, const BuildOptions& options) {
  if (references.empty()) return {};
  const auto count = static_cast<std::uint32_t>(references.size());
  NodeInput root{{0, count, count}, 0, {}, {}};
  for (const Reference& reference : references) {
    root.box = merge(root.box, reference.bounds());
    root.doubled_centroids = merge(root.doubled_centroids, reference.lower + reference.upper);
  }
  const BuildContext context{.arena = references.data(),
                             .max_leaf_size = options.max_leaf_size,
                             .min_spatial_count = min_spatial_count};
  return on_threads(options.threads, [&] {
    return ParallelBuilder(context, options, count, count)
        .build(root, references.capacity() * sizeof(Reference));
  });
}

std::size_t tree_memory_bound(std::size_t triangles, const BuildOptions& options) {
  const std::size_t references = max_references(triangles, options);
  const std::size_t tree = binary_tree_bytes(references);
  const std::size_t spilled = tree - references * sizeof(Reference);
  // Only nodes with room for more than `task_capacity` references have two top nodes below them. Nodes at one
  // depth share the arena, which limits how many of these there are.
  const std::size_t top_nodes = 1 + 2 * max_tree_depth * (references / task_capacity);
  const std::size_t scratch = static_cast<std::size_t>(usable_threads(options.threads)) *
                              Scratch::bytes(scratch_capacity(references));
  return references * sizeof(Reference) + spilled +
         top_nodes * (ParallelBuilder::bytes_per_top_node + ParallelBuilder::bytes_per_place) +
         std::max(scratch, tree);
}

}  // namespace kerf
