#include "build/split_bvh_builder.hpp"

#include <algorithm>

namespace kerf {
namespace {

// Median splits on the widest axis of the centroids: the first thin road, before the surface-area heuristic.
void split(BinaryTree& tree, std::vector<Reference>& references, std::uint32_t node, std::uint32_t begin,
           std::uint32_t end, std::uint32_t max_leaf_size) {
  Box3f bounds, centroids;
  for (std::uint32_t i = begin; i < end; ++i) {
    bounds = merge(bounds, references[i].bounds());
    centroids = merge(centroids, references[i].lower + references[i].upper);
  }
  tree.nodes[node].bounds = bounds;
  if (end - begin <= max_leaf_size) {
    tree.nodes[node].first = static_cast<std::uint32_t>(tree.references.size());
    tree.nodes[node].count = end - begin;
    for (std::uint32_t i = begin; i < end; ++i) tree.references.push_back(references[i].primitive);
    return;
  }
  const Vec3f size = extent(centroids);
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  const std::uint32_t middle = (begin + end) / 2;
  std::nth_element(references.begin() + begin, references.begin() + middle, references.begin() + end,
                   [axis](const Reference& a, const Reference& b) {
                     const float ca = a.lower[axis] + a.upper[axis];
                     const float cb = b.lower[axis] + b.upper[axis];
                     return ca != cb ? ca < cb : a.primitive < b.primitive;
                   });
  const auto left = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes.resize(tree.nodes.size() + 2);
  tree.nodes[node].first = left;
  split(tree, references, left, begin, middle, max_leaf_size);
  split(tree, references, left + 1, middle, end, max_leaf_size);
}

}  // namespace

BinaryTree build_object_split_tree(std::vector<Reference> references, const BuildOptions& options) {
  BinaryTree tree;
  if (references.empty()) return tree;
  tree.nodes.resize(1);
  split(tree, references, 0, 0, static_cast<std::uint32_t>(references.size()), options.max_leaf_size);
  return tree;
}

BinaryTree build_split_tree(const Geometry&, std::vector<Reference> references, const BuildOptions& options) {
  return build_object_split_tree(std::move(references), options);
}

}  // namespace kerf
