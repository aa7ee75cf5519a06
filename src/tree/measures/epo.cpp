// Each triangle is clipped down the tree. Its area in the boxes of nodes that do not have it below them
// counts.
#include "tree/measures/epo.hpp"

#include <cstdint>
#include <vector>

#include <kerf/inspect.hpp>

#include "base/parallel.hpp"
#include "base/scratch_pool.hpp"
#include "tree/polygon.hpp"

namespace kerf {
namespace {

// The leaves that reference each triangle, and the parents of all nodes.
struct LeavesOfTriangles {
  std::vector<std::uint32_t> first;   // of each triangle, its place in `leaves`; one more ends the last
  std::vector<std::uint32_t> leaves;  // node numbers
  std::vector<std::uint32_t> parent;  // of each node; the root is its own

  LeavesOfTriangles(const BinaryTree& tree, std::size_t triangle_count)
      : first(triangle_count + 1), leaves(tree.references.size()), parent(tree.nodes.size()) {
    for (const std::uint32_t id : tree.references) ++first[id + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
      const BinaryNode& node = tree.nodes[i];
      if (node.is_leaf()) {
        for (std::uint32_t k = 0; k < node.count; ++k) leaves[next[tree.references[node.first + k]]++] = i;
      } else {
        parent[node.left()] = parent[node.right()] = i;
      }
    }
  }
};

// The nodes that have the current triangle in their subtree are stamped with its number plus one.
using Stamps = std::vector<std::uint32_t>;

class Overlap {
 public:
  Overlap(const BinaryTree& tree, const Geometry& geometry)
      : tree_(tree), geometry_(geometry), owners_(tree, geometry.triangle_count()) {}

  struct Sum {
    double surface = 0.0;
    double overlap = 0.0;  // cost times area

    friend Sum operator+(const Sum& a, const Sum& b) {
      return {a.surface + b.surface, a.overlap + b.overlap};
    }
  };

  Sum sum() {
    // The grain fixes how the sum is divided, so that it is the same for any number of threads.
    constexpr std::size_t grain = 256;
    const auto count = static_cast<std::uint32_t>(geometry_.triangle_count());
    return parallel_sum<Sum>(count, grain, [this](const auto& range) {
      Sum sum;
      const auto stamps = stamps_.borrow([this] { return Stamps(tree_.nodes.size(), 0); });
      for (std::uint32_t id = range.begin(); id != range.end(); ++id) sum = sum + of_triangle(id, *stamps);
      return sum;
    });
  }

 private:
  Sum of_triangle(std::uint32_t id, Stamps& stamps) const {
    Sum sum;
    if (owners_.first[id] == owners_.first[id + 1]) return sum;
    const std::uint32_t stamp = id + 1;
    for (std::uint32_t i = owners_.first[id]; i < owners_.first[id + 1]; ++i) {
      for (std::uint32_t n = owners_.leaves[i]; stamps[n] != stamp; n = owners_.parent[n]) stamps[n] = stamp;
    }
    const Polygon polygon(geometry_.triangle(id));
    sum.surface = polygon.area();
    sum.overlap = below(0, polygon, stamp, stamps);
    return sum;
  }

  double below(std::uint32_t index, const Polygon& whole, std::uint32_t stamp, const Stamps& stamps) const {
    const BinaryNode& node = tree_.nodes[index];
    const Polygon part = clip(whole, node.bounds);
    const double area = part.area();
    if (area == 0.0) return 0.0;
    const double cost = node.is_leaf() ? triangle_cost * node.count : inner_node_cost;
    double overlap = stamps[index] == stamp ? 0.0 : cost * area;
    if (!node.is_leaf()) {
      overlap += below(node.left(), part, stamp, stamps) + below(node.right(), part, stamp, stamps);
    }
    return overlap;
  }

  const BinaryTree& tree_;
  const Geometry& geometry_;
  LeavesOfTriangles owners_;
  ScratchPool<Stamps> stamps_;
};

}  // namespace

double end_point_overlap(const BinaryTree& tree, const Geometry& geometry) {
  if (tree.empty()) return 0.0;
  const Overlap::Sum sum = Overlap(tree, geometry).sum();
  return sum.surface > 0.0 ? sum.overlap / sum.surface : 0.0;
}

}  // namespace kerf
