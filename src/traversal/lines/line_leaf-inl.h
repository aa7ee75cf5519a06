// A ray's line against all triangles of a leaf at once: what single precision tells for certain, and what it
// leaves to exact arithmetic.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_LINES_LINE_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_LINES_LINE_LEAF_INL_H
#undef KERF_TRAVERSAL_LINES_LINE_LEAF_INL_H
#else
#define KERF_TRAVERSAL_LINES_LINE_LEAF_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include <hwy/highway.h>

#include "layout/wide_bvh.hpp"
#include "simd/floats-inl.h"
#include "traversal/rays/prepared_ray.hpp"
#include "traversal/rays/wide_ray-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// A ray as the test of a leaf reads it.
struct LineConstants {
  Float8 origin[3], sx, sy, inverse_dz;  // as in `WideRay`
  Float8 error_of_corner;                // times the size of a triangle's corners: of an edge function
  Float8 error_of_mean, error_of_shear;  // of t
  Float8 t_min, t_max;
  std::size_t axis[3];
};

// A ray made ready for nodes and for leaves.
struct LineRay {
  WideRay wide;
  float t_max;     // of `wide`
  double unscale;  // the caller's t is one of `wide` times this power of two
  LineConstants leaf;
};

// In units of 2^-24 of D, the distance to the far side of the scene. A corner moves by 6 in the shear (see
// `RayBoxes`), and the rounding of an edge function's two products counts as 4 more. Twelve leaves room for
// the rounding of the bound itself.
constexpr float corner_error = 12.0f;

// False for a ray that crosses nothing, whatever the triangles.
HWY_INLINE bool set_up_line(const Ray& ray, const WideBvh& bvh, LineRay& out) {
  if (!(ray.t_min <= ray.t_max)) return false;
  constexpr float largest = std::numeric_limits<float>::max();
  double scale = 1.0;
  if (HWY_UNLIKELY(!set_up(ray, bvh, out.wide))) {
    const PreparedRay prepared({.origin = ray.origin, .direction = ray.direction},
                               is_far(far_side(ray.origin, bvh.bounds), bvh));
    if (!prepared.valid()) return false;
    const Ray scaled{.origin = prepared.origin, .direction = prepared.direction};
    if (!set_up<true>(scaled, bvh, out.wide)) return false;
    scale = prepared.scale;
  }
  const auto scaled = [scale](float t) {
    return static_cast<float>(std::clamp(t * scale, double{-largest}, double{largest}));
  };
  out.unscale = 1.0 / scale;
  out.wide.t_min = scaled(ray.t_min);
  out.t_max = scaled(ray.t_max);
  const WideRay& wide = out.wide;
  LineConstants& leaf = out.leaf;
  for (std::size_t i = 0; i < 3; ++i) {
    leaf.origin[i] = broadcast(wide.origin[i]);
    leaf.axis[i] = wide.axis[i];
  }
  leaf.sx = broadcast(wide.sx());
  leaf.sy = broadcast(wide.sy());
  leaf.inverse_dz = broadcast(wide.inverse_dz());
  // Where results might leave the range of a float, and for t in lengths of a scaled direction, everything is
  // left to exact arithmetic.
  const float infinity = std::numeric_limits<float>::infinity();
  const bool in_range = wide.min_value < infinity;
  const float unit = wide.error() / std::abs(wide.inverse_dz());  // 2^-24 D
  leaf.error_of_corner = broadcast(in_range ? corner_error * unit : infinity);
  leaf.error_of_mean =
      broadcast(in_range && scale == 1.0 ? LeafConstants::mean_error * wide.error() : infinity);
  leaf.error_of_shear = broadcast(LeafConstants::shear_error * wide.error());
  leaf.t_min = broadcast(ray.t_min);
  leaf.t_max = broadcast(ray.t_max);
  return true;
}

// Bit i stands for triangle i of the leaf.
struct LeafCrossings {
  std::uint32_t certain;  // crossed within the range
  std::uint32_t open;     // perhaps crossed, perhaps within the range
};

HWY_INLINE LeafCrossings cross_leaf(const LineConstants& line, const WideBvh& bvh, ChildLink leaf) {
  const std::uint32_t count = leaf.count();
  const float* rows = leaf_rows(bvh, leaf);
  struct Corner {
    Float8 x, y, z;
  };
  const auto corner = [&](const float* vertex_rows) HWY_ATTR {
    const Float8 z = load(vertex_rows + line.axis[2] * count) - line.origin[2];
    return Corner{load(vertex_rows + line.axis[0] * count) - line.origin[0] - line.sx * z,
                  load(vertex_rows + line.axis[1] * count) - line.origin[1] - line.sy * z, z};
  };
  const Corner a = corner(rows), b = corner(rows + 3 * count), c = corner(rows + 6 * count);
  const Float8 u = c.x * b.y - c.y * b.x, v = a.x * c.y - a.y * c.x, w = b.x * a.y - b.y * a.x;
  const Float8 min_edge = minimum(minimum(u, v), w), max_edge = maximum(maximum(u, v), w);
  // Each edge function errs by no more than the errors of its two corners times the other's size. The last
  // summand stands for products that underflow.
  const Float8 size = absolute(a.x) + absolute(a.y) + absolute(b.x) + absolute(b.y) + absolute(c.x) +
                      absolute(c.y) + line.error_of_corner;
  const Float8 error = size * line.error_of_corner + broadcast(SinglePrecision::min_value);
  const Float8 negative_error = broadcast(0.0f) - error;
  std::uint32_t perhaps = (1u << count) - 1;
  perhaps &= ~(less(min_edge, negative_error) & less(error, max_edge));
  if (perhaps == 0) return {0, 0};

  const std::uint32_t inside = perhaps & (less(error, min_edge) | less(max_edge, negative_error));
  // t as in `intersect_leaf`.
  const Float8 inverse = broadcast(1.0f) / (u + v + w);
  const Float8 t = (u * a.z + v * b.z + w * c.z) * inverse * line.inverse_dz;
  const Float8 rise = (absolute(b.x - a.x) + absolute(b.y - a.y)) * absolute(c.z - a.z) +
                      (absolute(c.x - a.x) + absolute(c.y - a.y)) * absolute(b.z - a.z);
  const Float8 error_of_t = line.error_of_mean + line.error_of_shear * rise * absolute(inverse);
  const Float8 first = t - error_of_t, last = t + error_of_t;
  const std::uint32_t out_of_range = less(last, line.t_min) | less(line.t_max, first);
  const std::uint32_t in_range = less_or_equal(line.t_min, first) & less_or_equal(last, line.t_max);
  return {inside & in_range, perhaps & ~(inside & (in_range | out_of_range))};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
