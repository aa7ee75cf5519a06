// Boxes as the build on the device sees them, and triangles cut by planes.
#pragma once

#include <cfloat>

#include "../predicates.hpp"

namespace kerf::cuda {

struct Box {
  float lower[3], upper[3];
};

KERF_CUDA_INLINE Box empty_box() {
  return {{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
}
KERF_CUDA_INLINE bool is_empty(const Box& box) {
  return !(box.lower[0] <= box.upper[0] && box.lower[1] <= box.upper[1] && box.lower[2] <= box.upper[2]);
}
KERF_CUDA_INLINE Box merge(const Box& a, const Box& b) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = minimum(a.lower[axis], b.lower[axis]);
    box.upper[axis] = maximum(a.upper[axis], b.upper[axis]);
  }
  return box;
}
KERF_CUDA_INLINE void grow(Box& box, const Vec3f& p) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = minimum(box.lower[axis], component(p, axis));
    box.upper[axis] = maximum(box.upper[axis], component(p, axis));
  }
}
KERF_CUDA_INLINE Box box_of(const Corners& t) {
  Box box = empty_box();
  grow(box, t.a);
  grow(box, t.b);
  grow(box, t.c);
  return box;
}

/// Half the surface area, in a unit in which the scene's extents are at most 1: `unit` is one over the
/// largest.
KERF_CUDA_INLINE float half_area(const Box& box, float unit) {
  const float x = (box.upper[0] - box.lower[0]) * unit, y = (box.upper[1] - box.lower[1]) * unit,
              z = (box.upper[2] - box.lower[2]) * unit;
  return x * (y + z) + y * z;
}

/// Grows both boxes by where the edge from `a` to `b` passes the plane; never too little.
KERF_CUDA_INLINE void grow_by_cut(const Vec3f& a, const Vec3f& b, int axis, float plane, Box& below,
                                  Box& above) {
  const double along = (static_cast<double>(plane) - component(a, axis)) /
                       (static_cast<double>(component(b, axis)) - component(a, axis));
  for (int k = 0; k < 3; ++k) {
    const double from = component(a, k), to = component(b, k);
    const double at = from + along * (to - from);
    // A handful of roundings of 2^-53, and that to a float.
    const double error = 0x1p-49 * (absolute(from) + absolute(to));
    const double margin = error + 0x1p-24 * absolute(at) + 0x1p-149;
    const auto low = static_cast<float>(at - margin), high = static_cast<float>(at + margin);
    below.lower[k] = minimum(below.lower[k], low);
    below.upper[k] = maximum(below.upper[k], high);
    above.lower[k] = minimum(above.lower[k], low);
    above.upper[k] = maximum(above.upper[k], high);
  }
}

/// Boxes around the parts of the triangle in `box` below and above a plane inside it. One of them may be
/// empty.
KERF_CUDA_BOTH inline void cut(const Corners& t, const Box& box, int axis, float plane, Box& below,
                               Box& above) {
  below = empty_box();
  above = empty_box();
  const Vec3f corner[3] = {t.a, t.b, t.c};
  for (int i = 0; i < 3; ++i) {
    const Vec3f &a = corner[i], &b = corner[i == 2 ? 0 : i + 1];
    const float from = component(a, axis), to = component(b, axis);
    if (from <= plane) grow(below, a);
    if (from >= plane) grow(above, a);
    if ((from < plane && to > plane) || (from > plane && to < plane))
      grow_by_cut(a, b, axis, plane, below, above);
  }
  for (int k = 0; k < 3; ++k) {
    below.lower[k] = maximum(below.lower[k], box.lower[k]);
    below.upper[k] = minimum(below.upper[k], k == axis ? plane : box.upper[k]);
    above.lower[k] = maximum(above.lower[k], k == axis ? plane : box.lower[k]);
    above.upper[k] = minimum(above.upper[k], box.upper[k]);
  }
}

/// The scene cut into cubes, 2^21 along its longest extent.
struct Grid {
  static constexpr int bits = 21;
  float origin[3];
  float cell;   // a cube's side
  float cells;  // one over it
  float unit;   // see `half_area`

  KERF_CUDA_INLINE std::uint32_t of(float x, int axis) const {
    const float at = (x - origin[axis]) * cells;
    const float last = static_cast<float>((1 << bits) - 1);
    return static_cast<std::uint32_t>(at > 0.0f ? (at < last ? at : last) : 0.0f);
  }
  KERF_CUDA_INLINE float plane(std::uint32_t number, int axis) const {
    return origin[axis] + static_cast<float>(number) * cell;
  }
};
inline Grid grid_over(const Box& scene) {
  Grid grid{};
  float extent = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin[axis] = scene.lower[axis];
    extent = maximum(extent, scene.upper[axis] - scene.lower[axis]);
  }
  grid.unit = extent > 0x1p-100f ? 1.0f / extent : 1.0f;
  grid.cell = extent > 0x1p-100f ? extent * (1.0f / (1 << Grid::bits)) : 1.0f;
  grid.cells = extent > 0x1p-100f ? static_cast<float>(1 << Grid::bits) * grid.unit : 1.0f;
  return grid;
}

/// The place along Morton's curve of a point in the grid.
KERF_CUDA_INLINE std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffffu;
  x = (x | x << 16) & 0x001f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  x = (x | x << 2) & 0x1249249249249249u;
  return x;
}
KERF_CUDA_INLINE std::uint64_t morton(const Box& box, const Grid& grid) {
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float middle = 0.5f * box.lower[axis] + 0.5f * box.upper[axis];
    code |= spread_bits(grid.of(middle, axis)) << axis;
  }
  return code;
}

}  // namespace kerf::cuda
