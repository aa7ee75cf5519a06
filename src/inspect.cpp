#include <optional>
#include <utility>

#include <kerf/inspect.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "build.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"
#include "traversal/rays/tree_ray.hpp"
#include "tree/measures/counts.hpp"
#include "tree/measures/epo.hpp"
#include "tree/measures/lcv.hpp"
#include "tree/measures/sah.hpp"

namespace kerf {

struct TreeContent {
  std::vector<TriangleMesh> meshes;
  Geometry geometry{meshes};
  BinaryTree tree;

  TreeContent(std::span<const TriangleMesh> given, const BuildOptions& options)
      : meshes(given.begin(), given.end()), tree(make_tree(geometry, options)) {}

  static Tree share(std::shared_ptr<const TreeContent> content) {
    return Tree(SharedPointer<TreeContent>::share(std::move(content)));
  }

  static const TreeContent& of(const Tree& tree) {
    static const TreeContent nothing{{}, {}};
    return tree.content_.get() != nullptr ? *tree.content_ : nothing;
  }
};

template class Shared<TreeContent>;

namespace {

// Calls `measure(tree, geometry)`.
template <class Measure>
auto measured(const Tree& tree, const Measure& measure) {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    const TreeContent& content = TreeContent::of(tree);
    return isolated([&] { return measure(content.tree, content.geometry); });
  });
}

}  // namespace

std::span<const BinaryNode> Tree::nodes() const {
  return TreeContent::of(*this).tree.nodes;
}
std::span<const std::uint32_t> Tree::references() const {
  return TreeContent::of(*this).tree.references;
}
std::size_t Tree::triangles() const {
  return TreeContent::of(*this).geometry.triangle_count();
}
std::size_t Tree::degenerate_triangles() const {
  return TreeContent::of(*this).tree.degenerate_triangles;
}
std::size_t Tree::non_finite_triangles() const {
  return TreeContent::of(*this).tree.non_finite_triangles;
}
PrimitiveId Tree::locate(std::uint32_t id) const {
  return TreeContent::of(*this).geometry.locate(id);
}
Triangle Tree::triangle(std::uint32_t id) const {
  return TreeContent::of(*this).geometry.triangle(id);
}

Tree build_tree(std::span<const TriangleMesh> meshes, const BuildOptions& options) {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    return isolated([&] { return TreeContent::share(std::make_shared<const TreeContent>(meshes, options)); });
  });
}

Tree build_tree(const TriangleMesh& mesh, const BuildOptions& options) {
  return build_tree(std::span<const TriangleMesh>(&mesh, 1), options);
}

Bvh make_bvh(const Tree& tree, unsigned threads) {
  return measured(tree, [&](const BinaryTree& binary, const Geometry& geometry) {
    return Structure::share(lay_out_tree(geometry, binary, threads));
  });
}

TreeCounts count_tree(const Tree& tree) {
  return measured(tree, [](const BinaryTree& binary, const Geometry&) { return count_tree(binary); });
}
double surface_area_cost(const Tree& tree) {
  return measured(tree, [](const BinaryTree& binary, const Geometry&) { return surface_area_cost(binary); });
}
double end_point_overlap(const Tree& tree) {
  return estimate_end_point_overlap(tree).value;
}
Estimate estimate_end_point_overlap(const Tree& tree) {
  return measured(tree, [](const BinaryTree& binary, const Geometry& geometry) {
    return end_point_overlap(binary, geometry);
  });
}
double leaf_count_variability(const Tree& tree) {
  return measured(tree,
                  [](const BinaryTree& binary, const Geometry&) { return leaf_count_variability(binary); });
}

std::optional<Hit> intersect(const Tree& tree, const Ray& ray, TraversalCounters& counters) {
  const TreeContent& content = TreeContent::of(tree);
  Hit hit = trace_tree(content.tree, content.geometry, ray, false, counters);
  if (!hit) return std::nullopt;
  const PrimitiveId id = content.geometry.locate(hit.primitive);
  hit.primitive = id.primitive;
  hit.mesh = id.mesh;
  return hit;
}

bool occluded(const Tree& tree, const Ray& ray, TraversalCounters& counters) {
  const TreeContent& content = TreeContent::of(tree);
  return static_cast<bool>(trace_tree(content.tree, content.geometry, ray, true, counters));
}

Layout layout(const Bvh& bvh) {
  const Structure& structure = Structure::of(bvh);
  return {.width = structure.wide.width,
          .node_count = structure.wide.node_count,
          .nodes = structure.wide.node_data,
          .leaves = structure.wide.leaves,
          .bounds = structure.wide.bounds,
          .largest_coordinate = structure.wide.largest_coordinate,
          .depth = structure.wide.depth,
          .first_triangles = structure.first_triangles};
}

std::string_view instruction_set() {
  return choose_kernels().target;
}

std::string_view instruction_set(const Bvh& bvh) {
  const Kernels* const kernels = Structure::of(bvh).kernels;
  return kernels == nullptr ? std::string_view() : kernels->target;
}

std::uint64_t repeat_node_steps(const Bvh& bvh, const Ray& ray, std::size_t count) {
  const Structure& structure = Structure::of(bvh);
  return structure.kernels->repeat_node_steps(structure.wide, ray, count);
}

std::uint64_t repeat_leaf_tests(const Bvh& bvh, const Ray& ray, ChildLink leaf, std::size_t count) {
  const Structure& structure = Structure::of(bvh);
  return structure.kernels->repeat_leaf_tests(structure.wide, ray, leaf, count);
}

Bvh join_meshes(const Bvh& bvh) {
  return report_out_of_memory([&] {
    auto joined = std::make_shared<Structure>(Structure::of(bvh));
    joined->first_triangles = {0, static_cast<std::uint32_t>(joined->statistics.triangles)};
    joined->masks.clear();  // one mesh, which every ray sees
    return Structure::share(std::move(joined));
  });
}

}  // namespace kerf
