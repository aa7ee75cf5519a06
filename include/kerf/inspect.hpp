// What tools look at between meshes and hits: builders by name, the tree between builder and layout, how good
// it is, and what a traversal does. `build` and `Bvh` need none of this.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <kerf/build.hpp>
#include <kerf/bvh.hpp>
#include <kerf/counters.hpp>
#include <kerf/export.hpp>
#include <kerf/layout.hpp>
#include <kerf/mesh.hpp>
#include <kerf/tree.hpp>

namespace kerf {

/// A builder by the name that a user writes.
struct BuilderInfo {
  Builder builder;           ///< for `BuildOptions`
  std::string_view name;     ///< lower-case letters
  std::string_view meaning;  ///< one line, without a full stop
};

/// All builders.
KERF_API std::span<const BuilderInfo> builders();

/// The first stage of `build`: checks options and meshes as that does and returns the tree. Throws as it
/// does.
KERF_API Tree build_tree(std::span<const TriangleMesh> meshes, const BuildOptions& options = {});
/// The same for one mesh.
KERF_API Tree build_tree(const TriangleMesh& mesh, const BuildOptions& options = {});

/// The last stage of `build`: from a tree to the structure that is traced, on `threads` threads, 0 for all.
/// Throws `Error::too_large` or `out_of_memory`. Of the statistics, `build_seconds` is 0.
KERF_API Bvh make_bvh(const Tree& tree, unsigned threads = 0);

/// The cost of visiting an inner node, which is two box tests (Aila, Karras & Laine 2013, "On Quality Metrics
/// of Bounding Volume Hierarchies", section 2).
inline constexpr double inner_node_cost = 1.2;
/// The cost of testing a triangle, from the same source.
inline constexpr double triangle_cost = 1.0;

/// What a tree holds.
struct TreeCounts {
  std::size_t references = 0;           ///< triangles in leaves, each counted once per leaf
  std::size_t nodes = 0;                ///< inner nodes and leaves
  std::size_t leaves = 0;               ///< leaves alone
  std::size_t depth = 0;                ///< of the leaf farthest from the root; 0 where the root is a leaf
  std::vector<std::size_t> leaf_sizes;  ///< leaf_sizes[k] leaves have k references
};

/// Throws `Error::out_of_memory`, as do the measures below.
KERF_API TreeCounts count_tree(const Tree& tree);

/// The surface area heuristic: (1.2 * sum of A(inner) + 1.0 * sum of A(leaf) * references(leaf)) / A(root),
/// the cost of a random line through the whole root. 0 for an empty tree or a root without area.
KERF_API double surface_area_cost(const Tree& tree);

/// End-point overlap (Aila et al. 2013, section 4): the cost, over a random point of the surface, of the
/// nodes whose boxes hold the point though no triangle below them does,
///
///     EPO = 1 / A(S) * sum over nodes n of cost(n) * A(S in box(n), without the triangles of n's subtree),
///
/// where cost is 1.2 for an inner node and 1.0 per reference for a leaf, and the surface S is that of all
/// triangles that the tree references. A triangle belongs to a subtree if any leaf under it references the
/// triangle. 0 for an empty tree. All cores.
///
/// Where so many boxes lie over one another that n triangles would take the square of n, as many of them as a
/// multiple of n log n allows stand for all; `estimate_end_point_overlap` says how well.
KERF_API double end_point_overlap(const Tree& tree);

/// A number, and the standard error with which it stands for the exact one.
struct Estimate {
  double value = 0.0;           ///< what was found
  double standard_error = 0.0;  ///< 0: the value is exact
};

/// The same measure, with what sampling may have taken from it.
KERF_API Estimate estimate_end_point_overlap(const Tree& tree);

/// Leaf count variability (Aila et al. 2013, section 5): the standard deviation of the number of leaves whose
/// boxes a line through the root's box meets, over 2^16 lines that are the same on each run. Over fewer, 64
/// or more, where these would meet more than 2^28 nodes. All cores.
KERF_API double leaf_count_variability(const Tree& tree);

/// The same traversal as `Bvh::intersect`, which adds to `counters` what it did.
KERF_API std::optional<Hit> intersect(const Bvh& bvh, const Ray& ray, TraversalCounters& counters);

/// The same traversal as `Bvh::occluded`, which adds to `counters` what it did.
KERF_API bool occluded(const Bvh& bvh, const Ray& ray, TraversalCounters& counters);

/// The closest hit by way of the binary tree itself, one node at a time: two boxes a step, the nearer child
/// first, and a stack. That is the traversal of the figures in Stich et al. 2009 (its kernels are those of
/// Aila & Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs"), with which trees are compared
/// that wide nodes level out. The hit is that of `Bvh::intersect`, which is several times as fast. Adds to
/// `counters` what it did.
KERF_API std::optional<Hit> intersect(const Tree& tree, const Ray& ray, TraversalCounters& counters);

/// The same for any hit, as `Bvh::occluded`.
KERF_API bool occluded(const Tree& tree, const Ray& ray, TraversalCounters& counters);

/// Highway's name of the instruction set that hierarchies are traced with from now on: the best of this
/// machine, or the one that the environment variable KERF_TARGET names.
KERF_API std::string_view instruction_set();

/// Highway's name of the instruction set that `bvh` is traced with; nothing for a hierarchy of nothing.
KERF_API std::string_view instruction_set(const Bvh& bvh);

/// For measuring what a step of `Bvh::intersect` costs when nothing waits for memory: `ray` visits the root
/// `count` times. `bvh` must not be a hierarchy of nothing. The result means nothing.
KERF_API std::uint64_t repeat_node_steps(const Bvh& bvh, const Ray& ray, std::size_t count);

/// The same for the visit of one leaf of the layout.
KERF_API std::uint64_t repeat_leaf_tests(const Bvh& bvh, const Ray& ray, ChildLink leaf, std::size_t count);

/// The same hierarchy, with all triangles in one mesh: their numbers counted over all meshes become those
/// within mesh 0. Shares the memory of `bvh`. Throws `Error::out_of_memory`.
KERF_API Bvh join_meshes(const Bvh& bvh);

}  // namespace kerf

#endif  // KERF_HAS_CPP20
