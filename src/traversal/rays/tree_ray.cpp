#include "traversal/rays/tree_ray.hpp"

#include <array>
#include <limits>

#include "layout/wide_bvh.hpp"
#include "math/ray_box.hpp"
#include "math/ray_triangle.hpp"
#include "traversal/rays/prepared_ray.hpp"

namespace kerf {
namespace {

constexpr float missed = std::numeric_limits<float>::infinity();

class TreeRay {
 public:
  TreeRay(const BinaryTree& tree, const Geometry& geometry, const Ray& caller, const PreparedRay& ray)
      : tree_(tree),
        geometry_(geometry),
        caller_(caller),
        ray_(ray),
        boxes_(ray.origin, ray.direction, tree.nodes[0].bounds),
        shear_(ray.direction) {
    best_.t = ray.t_max;
  }

  // The nearer child first (Aila & Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs"); the
  // other one waits on the stack, unless a hit lies before its box.
  Hit trace(bool any_hit, TraversalCounters& counters) {
    struct Waiting {
      float entry;
      std::uint32_t node;
    };
    std::array<Waiting, max_tree_depth + 1> stack;
    std::size_t count = 0;
    stack[count++] = {entry(0), 0};
    while (count != 0) {
      const Waiting next = stack[--count];
      if (next.entry == missed || next.entry > best_.t) continue;
      const BinaryNode& node = tree_.nodes[next.node];
      if (node.is_leaf()) {
        ++counters.leaves;
        counters.triangle_tests += node.count;
        if (test(node) && any_hit) return best_;
        continue;
      }
      ++counters.steps;
      const Waiting left{entry(node.left()), node.left()}, right{entry(node.right()), node.right()};
      const bool left_first = left.entry <= right.entry;
      stack[count++] = left_first ? right : left;
      stack[count++] = left_first ? left : right;
    }
    return best_;
  }

 private:
  float entry(std::uint32_t node) const {
    return boxes_.entry(tree_.nodes[node].bounds, ray_.t_min, best_.t);
  }

  bool test(const BinaryNode& leaf) {
    bool found = false;
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      Hit hit;
      const std::uint32_t id = tree_.references[i];
      if (!intersect_triangle(shear_, ray_.origin, ray_.direction, geometry_.triangle(id), ray_.t_min,
                              best_.t, hit))
        continue;
      // A range that was scaled is a little too large.
      const float t = ray_.unscaled(hit.t);
      if (!(t >= caller_.t_min && t <= caller_.t_max)) continue;
      hit.primitive = id;
      hit.mesh = 0;
      if (hit.t < best_.t || id < best_.primitive) best_ = hit;
      found = true;
    }
    return found;
  }

  const BinaryTree& tree_;
  const Geometry& geometry_;
  const Ray& caller_;
  const PreparedRay& ray_;
  const RayBoxes boxes_;
  const RayShear shear_;
  Hit best_;
};

}  // namespace

Hit trace_tree(const BinaryTree& tree, const Geometry& geometry, const Ray& ray, bool any_hit,
               TraversalCounters& counters) {
  if (tree.empty()) return {};
  const Box3f& scene = tree.nodes[0].bounds;
  const bool is_far = !(far_side(ray.origin, scene) + largest_coordinate(scene) < PreparedRay::far);
  const PreparedRay prepared(ray, is_far);
  if (!prepared.valid()) return {};
  Hit hit = TreeRay(tree, geometry, ray, prepared).trace(any_hit, counters);
  if (!hit) return {};
  hit.t = prepared.unscaled(hit.t);
  return hit;
}

}  // namespace kerf
