// Whether a point lies inside a closed surface, decided exactly as the library does it.
#pragma once

#include "crossings.hpp"

namespace kerf::cuda {

KERF_CUDA_INLINE bool in_box(const Vec3f& p, float lower_x, float upper_x, float lower_y, float upper_y,
                             float lower_z, float upper_z) {
  return lower_x <= p.x && p.x <= upper_x && lower_y <= p.y && p.y <= upper_y && lower_z <= p.z &&
         p.z <= upper_z;
}
KERF_CUDA_INLINE bool in_box(const Vec3f& p, const Words4& xy, std::uint32_t lower_z, std::uint32_t upper_z) {
  return in_box(p, as_float(xy.x), as_float(xy.y), as_float(xy.z), as_float(xy.w), as_float(lower_z),
                as_float(upper_z));
}

KERF_CUDA_INLINE bool on_surface(const BinaryHierarchy& hierarchy, const Vec3f& point) {
  std::uint32_t stack[max_depth + 1];
  std::uint32_t depth = 0, link = 0;
  while (true) {
    if ((link & leaf_bit) == 0) {
      const Words4* node = reinterpret_cast<const Words4*>(hierarchy.nodes + link);
      const Words4 first = load(node), second = load(node + 1), z = load(node + 2), links = load(node + 3);
      if (in_box(point, first, z.x, z.y)) stack[depth++] = links.x;
      if (in_box(point, second, z.z, z.w)) stack[depth++] = links.y;
    } else {
      const DeviceTriangle* triangle = hierarchy.triangles + leaf_first(link);
      for (std::uint32_t i = 0, count = leaf_count(link); i < count; ++i)
        if (lies_on(point, corners_of(triangle[i])) && number_of(triangle[i]) != invalid_id) return true;
    }
    if (depth == 0) return false;
    link = stack[--depth];
  }
}

KERF_CUDA_INLINE bool contains(const BinaryHierarchy& hierarchy, const Vec3f& point) {
  if (hierarchy.node_count == 0) return false;
  const SceneBounds bounds = *hierarchy.bounds;
  if (!in_box(point, bounds.lower[0], bounds.upper[0], bounds.lower[1], bounds.upper[1], bounds.lower[2],
              bounds.upper[2]))
    return false;
  if (on_surface(hierarchy, point)) return true;
  Ray ray;
  ray.origin = point;
  ray.direction.x = 0.8571f;  // askew to all coordinate planes; any direction gives the same answer
  ray.direction.y = 0.3163f;
  ray.direction.z = 0.4067f;
  ray.t_min = 0.0f;
  ray.t_max = as_float(0x7f800000u);
  return (count_crossings(hierarchy, ray) & 1) != 0;
}

}  // namespace kerf::cuda
