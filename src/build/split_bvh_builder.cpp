#include "build/split_bvh_builder.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include <tbb/global_control.h>

#include "build/input.hpp"
#include "build/progress.hpp"
#include "build/subtree.hpp"
#include "parallel.hpp"
#include "scratch_pool.hpp"
#include "tree/aligned_array.hpp"

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
  std::unique_ptr<Part> left, right;   // null for a finished subtree, which is stored
  const std::byte* stored = nullptr;   // as its nodes, then its references
  std::unique_ptr<std::byte[]> spill;  // owns what is stored, where that did not fit into the arena
  SubtreeSize size{};
};

class Driver {
 public:
  Driver(const BuildContext& context, const BuildOptions& options, std::uint32_t count)
      : context_(context), progress_(options.progress, count) {}

  BinaryTree build(const NodeInput& root, std::size_t arena_bytes) {
    Part top;
    build_part(top, root);
    BinaryTree tree = assemble(top);
    tree.build_peak_bytes = arena_bytes + scratch_.size() * Scratch::bytes + spilled_bytes_ +
                            tree.nodes.capacity() * sizeof(BinaryNode) +
                            tree.references.capacity() * sizeof(std::uint32_t);
    return tree;
  }

 private:
  void build_part(Part& part, const NodeInput& node) {
    progress_.check();
    part.box = node.box;
    NodeInput left, right;
    if (node.range.capacity() <= task_capacity || !split_node(context_, node, left, right)) {
      return build_subtree_of(part, node);
    }
    part.left = std::make_unique<Part>();
    part.right = std::make_unique<Part>();
    parallel_invoke([&] { build_part(*part.left, left); }, [&] { build_part(*part.right, right); });
  }

  // What was built takes the place of the references that it was built from, which nobody needs any more.
  void build_subtree_of(Part& part, const NodeInput& node) {
    const auto scratch = scratch_.borrow([] { return Scratch(); });
    part.size = build_subtree(context_, node, scratch->nodes.get(), scratch->references.get());
    const std::size_t node_bytes = part.size.nodes * sizeof(BinaryNode);
    const std::size_t bytes = node_bytes + part.size.references * sizeof(std::uint32_t);
    auto* place = reinterpret_cast<std::byte*>(context_.arena + node.range.begin);
    if (bytes > node.range.capacity() * sizeof(Reference)) {
      part.spill.reset(new std::byte[bytes]);
      place = part.spill.get();
      spilled_bytes_ += bytes;
    }
    std::memcpy(place, scratch->nodes.get(), node_bytes);
    std::memcpy(place + node_bytes, scratch->references.get(), bytes - node_bytes);
    part.stored = place;
    progress_.add(node.range.count());
  }

  // A finished subtree, and where it goes. Its root stands beside its sibling, the rest of it together.
  struct Job {
    const Part* part;
    std::uint32_t root, nodes, references;
  };

  BinaryTree assemble(const Part& top) {
    BinaryTree tree;
    std::vector<Job> jobs;
    std::vector<std::pair<std::uint32_t, BinaryNode>> inner;
    std::uint32_t nodes = 1, references = 0;
    number(top, 0, nodes, references, jobs, inner);
    tree.nodes.resize(nodes);
    tree.references.resize(references);
    for (const auto& [slot, node] : inner) tree.nodes[slot] = node;
    parallel_for(jobs.size(), [&](std::size_t i) { copy(jobs[i], tree); });
    return tree;
  }

  // In the order of a depth-first build on one thread, so that the tree is the same for any number of them.
  void number(const Part& part, std::uint32_t slot, std::uint32_t& nodes, std::uint32_t& references,
              std::vector<Job>& jobs, std::vector<std::pair<std::uint32_t, BinaryNode>>& inner) {
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
    const std::size_t node_bytes = size.nodes * sizeof(BinaryNode);
    for (std::uint32_t i = 0; i < size.nodes; ++i) {
      BinaryNode& node = tree.nodes[i == 0 ? job.root : job.nodes + i - 1];
      std::memcpy(&node, job.part->stored + i * sizeof(BinaryNode), sizeof(BinaryNode));
      node.first += node.is_leaf() ? job.references : job.nodes - 1;
    }
    std::memcpy(tree.references.data() + job.references, job.part->stored + node_bytes,
                size.references * sizeof(std::uint32_t));
  }

  const BuildContext& context_;
  Progress progress_;
  std::atomic<std::size_t> spilled_bytes_ = 0;
  ScratchPool<Scratch> scratch_;
};

// oneTBB has no more threads than this for anyone, and warns whoever asks for more.
int threads_of(const BuildOptions& options) {
  const auto most =
      static_cast<unsigned>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  return static_cast<int>(options.threads == 0 ? most : std::min(options.threads, most));
}

// Spatial splits of smaller nodes are rarely found and gain little: trying them only here costs 0.1 % of the
// surface-area cost on sponza and saves half the time (docs/decisions.md). With an alpha of 0, all are tried.
constexpr std::uint32_t worthwhile_count = 64;
constexpr float worthwhile_overlap = 0.05f;

bool splits_space(const BuildOptions& options) {
  return options.builder == Builder::sbvh && options.alpha < 1.0f;
}

std::size_t references_in_arena(std::size_t triangles, const BuildOptions& options) {
  const double ratio = splits_space(options) ? double{options.max_reference_ratio} : 1.0;
  return static_cast<std::size_t>(static_cast<double>(triangles) * ratio);
}

}  // namespace

BinaryTree build_split_tree(const Geometry& geometry, const BuildOptions& options) {
  if (geometry.triangle_count() == 0) return {};
  const std::size_t room = references_in_arena(geometry.triangle_count(), options);
  if (room >= (std::size_t{1} << 31)) {
    throw Error(Error::too_large, "there may be 2^31 references or more, which is more than kerf can number");
  }
  const AlignedArray<Reference> arena(room);
  tbb::task_arena threads(threads_of(options));
  return execute_in(threads, [&]() -> BinaryTree {
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
      const auto limit = static_cast<std::uint32_t>(references_in_arena(input.count, options));
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
  tbb::task_arena threads(threads_of(options));
  return execute_in(threads, [&] {
    return Driver(context, options, count).build(root, references.capacity() * sizeof(Reference));
  });
}

std::size_t build_memory_bound(std::size_t triangles, const BuildOptions& options) {
  const std::size_t references = references_in_arena(triangles, options);
  const auto threads = static_cast<std::size_t>(threads_of(options));
  const std::size_t tree = references * (2 * sizeof(BinaryNode) + sizeof(std::uint32_t));
  return references * sizeof(Reference) + 2 * tree + threads * Scratch::bytes;
}

}  // namespace kerf
