// Large triangles are split before the build, where that promises most (Karras & Aila 2013, "Fast Parallel
// Construction of High-Quality Bounding Volume Hierarchies", section 4), into no more references than are
// allowed.
#pragma once

#include "../triangle_test.hpp"
#include "boxes.hpp"

namespace kerf::cuda {

/// A triangle's box or, where it is split, the box of a part.
struct Reference {
  Box box;
  std::uint32_t triangle;  // `invalid_id` for a place that was left empty
};

KERF_CUDA_INLINE Corners corners_in(const DeviceTriangle& t) {
  Corners corners;
  Vec3f* const to[3] = {&corners.a, &corners.b, &corners.c};
  for (int i = 0; i < 3; ++i) {
    to[i]->x = as_float(t.corner[i].x);
    to[i]->y = as_float(t.corner[i].y);
    to[i]->z = as_float(t.corner[i].z);
  }
  return corners;
}

/// The most important plane of the grid inside a box: the one that halves the scene or the largest part of
/// it.
struct SplitPlane {
  int axis;   // -1: none
  int level;  // 0 halves the scene's longest extent
  float position;
};
KERF_CUDA_INLINE SplitPlane most_important_plane(const Box& box, const Grid& grid) {
  SplitPlane best{-1, Grid::bits, 0.0f};
  float best_extent = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t first = grid.of(box.lower[axis], axis), last = grid.of(box.upper[axis], axis);
    if (first == last) continue;
    const int bit = highest_bit(first ^ last), level = Grid::bits - 1 - bit;
    const float extent = box.upper[axis] - box.lower[axis];
    if (level > best.level || (level == best.level && extent <= best_extent)) continue;
    const float position = grid.plane((last >> bit) << bit, axis);
    if (!(position > box.lower[axis] && position < box.upper[axis])) continue;
    best = {axis, level, position};
    best_extent = extent;
  }
  return best;
}

/// How much there is to gain from splitting a triangle: (2^-level * (area of its box - area of the boxes of
/// infinitely many parts))^(1/3), in units of 2^-24.
KERF_CUDA_BOTH inline std::uint32_t split_priority(const Corners& t, const Box& box, const Grid& grid) {
  const SplitPlane plane = most_important_plane(box, grid);
  if (plane.axis < 0) return 0;
  float e[3], f[3];
  for (int axis = 0; axis < 3; ++axis) {
    e[axis] = (component(t.b, axis) - component(t.a, axis)) * grid.unit;
    f[axis] = (component(t.c, axis) - component(t.a, axis)) * grid.unit;
  }
  const float ideal = 0.5f * (absolute(e[1] * f[2] - e[2] * f[1]) + absolute(e[2] * f[0] - e[0] * f[2]) +
                              absolute(e[0] * f[1] - e[1] * f[0]));
  const float gain = half_area(box, grid.unit) - ideal;
  if (!(gain > 0.0f)) return 0;
  const float importance = as_float(static_cast<std::uint32_t>(127 - plane.level) << 23);
  return static_cast<std::uint32_t>(cbrtf(importance * gain) * 0x1p24f);
}

inline constexpr std::uint32_t max_splits = 255;  // of a triangle, which one thread makes

/// The number of splits of a triangle, in proportion to its priority.
KERF_CUDA_INLINE std::uint32_t splits_of(std::uint32_t priority, std::uint64_t factor) {
  const std::uint64_t splits = (static_cast<std::uint64_t>(priority) * factor) >> 32;
  return static_cast<std::uint32_t>(splits < max_splits ? splits : max_splits);
}

/// Splits a triangle into at most `splits + 1` references; returns their number.
KERF_CUDA_BOTH inline std::uint32_t split_triangle(const Corners& t, const Box& whole, std::uint32_t number,
                                                   std::uint32_t splits, const Grid& grid, Reference* out) {
  struct Part {
    Box box;
    std::uint32_t splits;
  };
  // The part with more splits waits: no more than the logarithm of all splits do.
  Part waiting[10];
  int depth = 0;
  std::uint32_t count = 0;
  Part part{whole, splits};
  while (true) {
    const SplitPlane plane =
        part.splits == 0 ? SplitPlane{-1, 0, 0.0f} : most_important_plane(part.box, grid);
    if (plane.axis < 0) {
      out[count++] = {part.box, number};
      if (depth == 0) return count;
      part = waiting[--depth];
      continue;
    }
    Part below, above;
    cut(t, part.box, plane.axis, plane.position, below.box, above.box);
    const std::uint32_t left = part.splits - 1;
    if (is_empty(below.box) || is_empty(above.box)) {
      part.box = is_empty(below.box) ? above.box : below.box;
      part.splits = left;
      if (is_empty(part.box)) part = {whole, 0};  // cannot be: the parts cover the triangle
      continue;
    }
    float longest[2] = {0.0f, 0.0f};
    for (int axis = 0; axis < 3; ++axis) {
      longest[0] = maximum(longest[0], (below.box.upper[axis] - below.box.lower[axis]) * grid.unit);
      longest[1] = maximum(longest[1], (above.box.upper[axis] - above.box.lower[axis]) * grid.unit);
    }
    const float sum = longest[0] + longest[1];
    const float share = sum > 0.0f ? longest[0] / sum : 0.5f;
    const auto to_below = static_cast<std::uint32_t>(static_cast<float>(left) * share + 0.5f);
    below.splits = to_below < left ? to_below : left;
    above.splits = left - below.splits;
    const bool below_waits = below.splits > above.splits;
    waiting[depth++] = below_waits ? below : above;
    part = below_waits ? above : below;
  }
}

}  // namespace kerf::cuda
