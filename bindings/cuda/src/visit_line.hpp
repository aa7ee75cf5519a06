// The triangles that a ray's line may cross, near ones first.
#pragma once

#include "binary_traversal.hpp"

namespace kerf::cuda {

/// Calls `visit(triangle)` for every reference in a leaf whose box the ray may meet in `[t_min, t_max]`, in
/// lengths of the prepared direction; `t_max` may fall meanwhile.
template <class Visit>
KERF_CUDA_INLINE void visit_line(const BinaryHierarchy& hierarchy, const TracedRay& ray, float t_min,
                                 const float& t_max, Visit&& visit) {
  if (hierarchy.node_count == 0) return;
  std::uint32_t stack[max_depth + 1];
  std::uint32_t depth = 0, link = 0;
  while (link != no_link) {
    if (link < no_link) {
      const Words4* node = reinterpret_cast<const Words4*>(hierarchy.nodes + link);
      const Words4 first = load(node), second = load(node + 1), z = load(node + 2), links = load(node + 3);
      float t_first, t_second;
      const bool in_first = ray.boxes.meet(first, z.x, z.y, t_min, t_max, t_first);
      const bool in_second = ray.boxes.meet(second, z.z, z.w, t_min, t_max, t_second);
      if (in_first && in_second) {
        const bool first_is_nearer = t_first <= t_second;
        link = first_is_nearer ? links.x : links.y;
        stack[depth++] = first_is_nearer ? links.y : links.x;
        continue;
      }
      if (in_first || in_second) {
        link = in_first ? links.x : links.y;
        continue;
      }
    } else {
      const DeviceTriangle* triangle = hierarchy.triangles + leaf_first(link);
      for (std::uint32_t i = 0, count = leaf_count(link); i < count; ++i) visit(triangle[i]);
    }
    link = depth == 0 ? no_link : stack[--depth];
  }
}

}  // namespace kerf::cuda
