#include "construction/sbvh/parallel_build.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include "base/aligned_array.hpp"
#include "base/parallel.hpp"
#include "base/scratch_pool.hpp"
#include "construction/input.hpp"
#include "construction/progress.hpp"
#include "construction/sbvh/finished_subtree.hpp"
#include "construction/sbvh/subtree.hpp"

namespace kerf {
namespace {

// A node with room for no more references than this becomes one task, which builds all that is under it.
// Small enough that what the task writes stays in the second-level cache, large enough that there is next to
// nothing to schedule.
constexpr std::uint32_t task_capacity = 4096;

// Where a task builds a subtree before it is stored. A subtree of n references has at most 2n - 1 nodes.
struct Scratch {
  std::unique_ptr<BinaryNode[]> nodes{new BinaryNode[2 * task_capacity]};
  std::unique_ptr<std::uint32_t[]> references{new std::uint32_t[task_capacity]};

  static constexpr std::size_t bytes = task_capacity * (2 * sizeof(BinaryNode) + sizeof(std::uint32_t));
};

// A node above the tasks, or all that one task built.
struct Part {
  Box3f box;
  std::unique_ptr<Part> left, right;  // null for a finished subtree
  SubtreeSize size{};                 // of the finished one
  FinishedSubtree stored;
};

class Driver {
 public:
  Driver(const BuildContext& context, const BuildOptions& options, std::uint32_t count)
      : context_(context), progress_(options.progress, count) {}

  BinaryTree build(const NodeInput& root, std::size_t arena_bytes) {
    Part top;
    std::size_t scratch_bytes;
    {
      ScratchPool<Scratch> scratch;
      build_part(top, root, scratch);
      scratch_bytes = scratch.size() * Scratch::bytes;
    }
    BinaryTree tree;
    const std::size_t assembly_bytes = assemble(top, tree);
    tree.build_peak_bytes = arena_bytes + spilled_bytes_ + parts_ * part_bytes +
                            std::max(scratch_bytes, tree.bytes() + assembly_bytes);
    return tree;
  }

 private:
  void build_part(Part& part, const NodeInput& node, ScratchPool<Scratch>& scratch) {
    progress_.check();
    part.box = node.box;
    NodeInput left, right;
    if (node.range.capacity() <= task_capacity || !split_node(context_, node, left, right)) {
      return build_subtree_of(part, node, scratch);
    }
    part.left = std::make_unique<Part>();
    part.right = std::make_unique<Part>();
    parts_ += 2;
    parallel_invoke([&] { build_part(*part.left, left, scratch); },
                    [&] { build_part(*part.right, right, scratch); });
  }

  // What was built takes the place of the references that it was built from, which nobody needs any more.
  void build_subtree_of(Part& part, const NodeInput& node, ScratchPool<Scratch>& pool) {
    const auto scratch = pool.borrow([] { return Scratch(); });
    part.size = build_subtree(context_, node, scratch->nodes.get(), scratch->references.get());
    part.stored = FinishedSubtree(part.size, scratch->nodes.get(), scratch->references.get(),
                                  context_.arena + node.range.begin, node.range.capacity());
    spilled_bytes_ += part.stored.spilled_bytes();
    progress_.add(node.range.count());
  }

  // A finished subtree, and where it goes. Its root stands beside its sibling, the rest of it together.
  struct Job {
    const Part* part;
    std::uint32_t root, nodes, references;
  };
  struct Inner {
    std::uint32_t slot;
    BinaryNode node;
  };

  // Returns what was held meanwhile beside the parts and the tree.
  std::size_t assemble(const Part& top, BinaryTree& tree) {
    std::vector<Job> jobs;
    std::vector<Inner> inner;
    jobs.reserve(parts_ / 2 + 1);
    inner.reserve(parts_ / 2);
    std::uint32_t nodes = 1, references = 0;
    number(top, 0, nodes, references, jobs, inner);
    tree.nodes.resize(nodes);
    tree.references.resize(references);
    parallel_for(jobs.size(), [&](std::size_t i) { copy(jobs[i], tree); });
    for (const auto& [slot, node] : inner) tree.nodes[slot] = node;
    return jobs.capacity() * sizeof(Job) + inner.capacity() * sizeof(Inner);
  }

  // In the order of a depth-first build on one thread, so that the tree is the same for any number of them.
  void number(const Part& part, std::uint32_t slot, std::uint32_t& nodes, std::uint32_t& references,
              std::vector<Job>& jobs, std::vector<Inner>& inner) {
    if (part.left == nullptr) {
      jobs.push_back({&part, slot, nodes, references});
      nodes += part.size.nodes - 1;
      references += part.size.references;
      return;
    }
    const std::uint32_t child = nodes;
    inner.push_back({slot, {.bounds = part.box, .first = child, .count = 0}});
    nodes += 2;
    number(*part.left, child, nodes, references, jobs, inner);
    number(*part.right, child + 1, nodes, references, jobs, inner);
  }

  static void copy(const Job& job, BinaryTree& tree) {
    const SubtreeSize size = job.part->size;
    for (std::uint32_t i = 0; i < size.nodes; ++i) {
      BinaryNode& node = tree.nodes[i == 0 ? job.root : job.nodes + i - 1];
      job.part->stored.read_node(i, node);
      node.first += node.is_leaf() ? job.references : job.nodes - 1;
    }
    job.part->stored.read_references(size, tree.references.data() + job.references);
  }

 public:
  // What is held for each part: itself, with what its allocation takes, and a job or an inner node.
  static constexpr std::size_t part_bytes = sizeof(Part) + 2 * sizeof(void*);
  static constexpr std::size_t assembly_bytes = std::max(sizeof(Job), sizeof(Inner));

 private:
  const BuildContext& context_;
  Progress progress_;
  std::atomic<std::size_t> spilled_bytes_ = 0, parts_ = 0;
};

// Spatial splits of smaller nodes are rarely found and gain little: trying them only here costs 0.1 % of the
// surface-area cost on sponza and saves half the time (docs/decisions/0011, 0012). With an alpha of 0, all
// are tried.
constexpr std::uint32_t worthwhile_count = 96;
constexpr float worthwhile_overlap = 0.05f;

bool splits_space(const BuildOptions& options) {
  return options.builder == Builder::sbvh && options.alpha < 1.0f;
}

}  // namespace

std::size_t most_references(std::size_t triangles, const BuildOptions& options) {
  const double ratio = splits_space(options) ? double{options.max_reference_ratio} : 1.0;
  return static_cast<std::size_t>(static_cast<double>(triangles) * ratio);
}

BinaryTree build_split_tree(const Geometry& geometry, const BuildOptions& options) {
  if (geometry.triangle_count() == 0) return {};
  const std::size_t room = most_references(geometry.triangle_count(), options);
  if (room >= (std::size_t{1} << 31)) {
    throw Error(Error::too_large, "there may be 2^31 references or more, which is more than kerf can number");
  }
  const AlignedArray<Reference> arena(room);
  return on_threads(options.threads, [&]() -> BinaryTree {
    const ReferenceSummary input = write_references(geometry, arena.data());
    BinaryTree tree;
    if (input.count != 0) {
      const float root_area = half_area(input.box);
      // Chopping could overflow where not even the area is finite: see math/clip.hpp.
      const bool can_chop = splits_space(options) && std::isfinite(root_area);
      const BuildContext context{.geometry = can_chop ? &geometry : nullptr,
                                 .arena = arena.data(),
                                 .max_leaf_size = options.max_leaf_size,
                                 .absolute_overlap = options.alpha * root_area,
                                 .relative_overlap = options.alpha > 0.0f ? worthwhile_overlap : 0.0f,
                                 .spatial_minimum = options.alpha > 0.0f ? worthwhile_count : 2};
      const auto limit = static_cast<std::uint32_t>(most_references(input.count, options));
      tree = Driver(context, options, input.count)
                 .build({{0, input.count, limit}, 0, input.box, input.doubled_centroids},
                        room * sizeof(Reference));
      tree.least_divided = context.geometry == nullptr ? ~std::uint32_t{0} : context.spatial_minimum;
    }
    tree.degenerate_triangles = input.degenerate_triangles;
    return tree;
  });
}

BinaryTree build_object_split_tree(std::vector<Reference> references, const BuildOptions& options) {
  if (references.empty()) return {};
  const auto count = static_cast<std::uint32_t>(references.size());
  NodeInput root{{0, count, count}, 0, {}, {}};
  for (const Reference& reference : references) {
    root.box = merge(root.box, reference.bounds());
    root.doubled_centroids = merge(root.doubled_centroids, reference.lower + reference.upper);
  }
  const BuildContext context{.arena = references.data(),
                             .max_leaf_size = options.max_leaf_size,
                             .spatial_minimum = worthwhile_count};
  return on_threads(options.threads, [&] {
    return Driver(context, options, count).build(root, references.capacity() * sizeof(Reference));
  });
}

std::size_t tree_memory_bound(std::size_t triangles, const BuildOptions& options) {
  const std::size_t references = most_references(triangles, options);
  const std::size_t tree = binary_tree_bytes(references);
  const std::size_t spilled = tree - references * sizeof(Reference);
  // Nodes of more than `task_capacity` places are parted, each in two: side by side there are no more than
  // fit.
  const std::size_t parts = 1 + 2 * max_tree_depth * (references / task_capacity);
  const std::size_t scratch = static_cast<std::size_t>(usable_threads(options.threads)) * Scratch::bytes;
  return references * sizeof(Reference) + spilled + parts * (Driver::part_bytes + Driver::assembly_bytes) +
         std::max(scratch, tree);
}

}  // namespace kerf
