#include "tree/measures/sah.hpp"

namespace kerf {
namespace {

// In double precision, because in single precision products of extents near the range of a float overflow.
double half_area_double(const Box3f& box) {
  const double x = double{box.upper.x} - box.lower.x;
  const double y = double{box.upper.y} - box.lower.y;
  const double z = double{box.upper.z} - box.lower.z;
  return x * (y + z) + y * z;
}

}  // namespace

double surface_area_cost(const BinaryTree& tree) {
  if (tree.empty()) return 0.0;
  double inner = 0.0, leaves = 0.0;
  for (const BinaryNode& node : tree.nodes) {
    const double area = half_area_double(node.bounds);
    if (node.is_leaf()) {
      leaves += area * node.count;
    } else {
      inner += area;
    }
  }
  const double root = half_area_double(tree.nodes[0].bounds);
  return root > 0.0 ? (inner_node_cost * inner + triangle_cost * leaves) / root : 0.0;
}

}  // namespace kerf
