// The library's watertight ray-triangle test (Woop, Benthin & Wald 2013), operation by operation: the same
// hits, bit for bit.
#pragma once

#include <limits>

#include "prepared_ray.hpp"
#include "ray_crossing.hpp"

namespace kerf::cuda {

/// A triangle as kernels read it: three corners of sixteen bytes each, the first with the triangle's number.
struct alignas(16) DeviceTriangle {
  Words4 corner[3];
};
static_assert(sizeof(DeviceTriangle) == 48);

/// The closest hit so far. Its t is known to lie between two bounds, which is nearly always enough to go on
/// with; what it is exactly is computed when the ray is done.
struct NearestHit {
  float first, last;        // bounds of t; t itself where both are the same
  std::uint32_t reference;  // its place in the hierarchy; `invalid_id` for none

  KERF_CUDA_INLINE bool found() const { return reference != invalid_id; }
};

struct ShearedCorner {
  float x, y, z;
};

KERF_CUDA_INLINE ShearedCorner sheared(const Shear& shear, const Vec3f& origin, const Vec3f& corner) {
  const float x = corner.x - origin.x, y = corner.y - origin.y, z = corner.z - origin.z;
  const std::uint32_t k = shear.axis_z;
  const float along = one_of(k, x, y, z), next = one_of(k, y, z, x), after_next = one_of(k, z, x, y);
  return {next - shear.x * along, after_next - shear.y * along, along};
}
KERF_CUDA_INLINE ShearedCorner shear(const Frame& frame, const Vec3f& origin, const Vec3f& corner) {
  const bool swapped = frame.swapped;
  const ShearedCorner c =
      sheared({frame.axis_z, swapped ? frame.sy : frame.sx, swapped ? frame.sx : frame.sy}, origin, corner);
  return swapped ? ShearedCorner{c.y, c.x, c.z} : c;
}

// a * b - c * d with the right sign (Kahan's algorithm; Jeannerod, Louvet & Muller 2013).
KERF_CUDA_INLINE float difference_of_products(float a, float b, float c, float d) {
  const float cd = c * d;
  return fused_multiply_add(a, b, -cd) + fused_multiply_add(-c, d, cd);
}

// Beyond these no edge function is shifted noticeably by what was lost below the range of a float, and
// nothing is infinite.
struct SinglePrecision {
  static constexpr float min_sign = 0x1p-100f;  // of an edge function, for its sign
  static constexpr float min_value = 0x1p-60f;  // for its value, too
  static constexpr float max_value = 0x1p126f;  // of the determinant
};

struct EdgeFunctions {
  float u, v, w, min_edge, max_edge;

  KERF_CUDA_INLINE EdgeFunctions(const ShearedCorner& a, const ShearedCorner& b, const ShearedCorner& c)
      : u(difference_of_products(c.x, b.y, c.y, b.x)),
        v(difference_of_products(a.x, c.y, a.y, c.x)),
        w(difference_of_products(b.x, a.y, b.y, a.x)),
        min_edge(minimum(minimum(u, v), w)),
        max_edge(maximum(maximum(u, v), w)) {}

  KERF_CUDA_INLINE bool certainly_outside() const {
    return min_edge < -SinglePrecision::min_sign && max_edge > SinglePrecision::min_sign;
  }
};

/// All of the library's `intersect_triangle`, for the few triangles that the quick way leaves open: no t
/// where there is no hit. By value, so that nothing of the quick way must lie in memory.
KERF_CUDA_NOINLINE RayCrossing hit_exactly(Vec3f o, Vec3f d, Corners triangle) {
  const RayCrossing none{as_float(0x7fc00000u), 0.0f, 0.0f};
  const Frame frame = frame_of(d);
  const ShearedCorner a = shear(frame, o, triangle.a), b = shear(frame, o, triangle.b),
                      c = shear(frame, o, triangle.c);
  const EdgeFunctions edges(a, b, c);
  if (edges.certainly_outside()) return none;
  const float determinant = edges.u + edges.v + edges.w;
  const bool trusted =
      (edges.min_edge > SinglePrecision::min_value || edges.max_edge < -SinglePrecision::min_value) &&
      absolute(determinant) < SinglePrecision::max_value;
  Vec3d weights{edges.u, edges.v, edges.w};
  if (!trusted) {
    // Products of two floats are exact in double precision.
    const double u = static_cast<double>(c.x) * b.y - static_cast<double>(c.y) * b.x;
    const double v = static_cast<double>(a.x) * c.y - static_cast<double>(a.y) * c.x;
    const double w = static_cast<double>(b.x) * a.y - static_cast<double>(b.y) * a.x;
    if (((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) || u + v + w == 0) return none;
    weights = {u, v, w};
  }
  const CrossingEstimate estimate = estimate_crossing(o, d, triangle);
  const bool steep = estimate.steep();
  if (steep && estimate.precise()) return estimate.crossing(estimate.height);
  RayCrossing crossing;
  if (cross_exactly(o, d, triangle, crossing)) return crossing;
  if (steep) return estimate.crossing(height_above(o, triangle));
  const int z = static_cast<int>(frame.axis_z);
  const float oz = component(o, z);
  const double sum = weights.x + weights.y + weights.z;
  const double height = weights.x * (component(triangle.a, z) - oz) +
                        weights.y * (component(triangle.b, z) - oz) +
                        weights.z * (component(triangle.c, z) - oz);
  return round_crossing(height / sum / frame.dz, weights.y / sum, weights.z / sum);
}

KERF_CUDA_INLINE Vec3f corner(const Words4& words) {
  return {as_float(words.x), as_float(words.y), as_float(words.z)};
}
KERF_CUDA_INLINE Corners corners_of(const DeviceTriangle& triangle) {
  return {corner(load(&triangle.corner[0])), corner(load(&triangle.corner[1])),
          corner(load(&triangle.corner[2]))};
}
KERF_CUDA_INLINE std::uint32_t number_of(const DeviceTriangle& triangle) {
  return load(&triangle.corner[0]).w;
}

// The ray's hit with a triangle, all in exact terms: t in lengths of the direction as it is traced. Out of
// line, as all that needs double precision is: it would leave no registers to the traversal.
KERF_CUDA_NOINLINE RayCrossing exact_hit(const Ray* ray, const SceneBounds* scene,
                                         const DeviceTriangle* triangle) {
  const ScaledRay scaled = scaled_ray(*ray, is_far(*ray, *scene));
  return hit_exactly(ray->origin, {scaled.direction[0], scaled.direction[1], scaled.direction[2]},
                     corners_of(*triangle));
}
/// t, u and v of a triangle that is hit.
KERF_CUDA_NOINLINE RayCrossing settled_hit(const Ray* ray, const SceneBounds* scene,
                                           const DeviceTriangle* triangle) {
  const ScaledRay scaled = scaled_ray(*ray, is_far(*ray, *scene));
  const Vec3f d{scaled.direction[0], scaled.direction[1], scaled.direction[2]};
  const CrossingEstimate estimate = estimate_crossing(ray->origin, d, corners_of(*triangle));
  if (estimate.steep() && estimate.precise()) return estimate.crossing(estimate.height);
  return exact_hit(ray, scene, triangle);
}

/// The triangle at `place` against the nearest so far, where single precision leaves open whether it is hit,
/// or lies behind `t_min`, or is the nearer. Of equal t the triangle with the lowest number is nearer.
KERF_CUDA_NOINLINE NearestHit nearer_of(const Ray* ray, const SceneBounds* scene, float t_min,
                                        const DeviceTriangle* triangles, std::uint32_t place,
                                        NearestHit nearest) {
  const std::uint32_t number = number_of(triangles[place]);
  const float t = exact_hit(ray, scene, triangles + place).t;
  if (!(t >= t_min && t <= nearest.last)) return nearest;
  if (nearest.first != nearest.last)
    nearest.first = nearest.last = settled_hit(ray, scene, triangles + nearest.reference).t;
  if (t > nearest.first) return nearest;
  if (t == nearest.first && nearest.found() && number >= number_of(triangles[nearest.reference]))
    return nearest;
  return {t, t, place};
}

/// Infinite for a triangle of which single precision tells whether it is nearer.
inline constexpr float decided_t = std::numeric_limits<float>::infinity();

/// Tests one triangle in single precision. Where any hit will do, that is all that `nearest` tells. A
/// triangle that might be nearer, or might not, is left out: the least t that it may have is returned.
template <bool any_hit>
KERF_CUDA_INLINE float test_triangle(const TracedRay& ray, const DeviceTriangle* triangles,
                                     std::uint32_t place, NearestHit& nearest) {
  const Words4 first_words = load(&triangles[place].corner[0]);
  const Corners corners{corner(first_words), corner(load(&triangles[place].corner[1])),
                        corner(load(&triangles[place].corner[2]))};
  const Vec3f o{ray.origin[0], ray.origin[1], ray.origin[2]};
  const ShearedCorner a = sheared(ray.shear, o, corners.a), b = sheared(ray.shear, o, corners.b),
                      c = sheared(ray.shear, o, corners.c);
  const EdgeFunctions edges(a, b, c);
  if (edges.certainly_outside()) return decided_t;
  // What t is for the point that the weights name, and how far from it the ray may cross the plane: the
  // shear's rounding, times how much the triangle rises along the ray for each step across it.
  const float inverse = near_reciprocal(edges.u + edges.v + edges.w);
  const float t = (edges.u * a.z + edges.v * b.z + edges.w * c.z) * inverse * ray.inverse_dz;
  const float rise = (absolute(b.x - a.x) + absolute(b.y - a.y)) * absolute(c.z - a.z) +
                     (absolute(c.x - a.x) + absolute(c.y - a.y)) * absolute(b.z - a.z);
  const float error = ray.error_unit * (ErrorOfT::mean + ErrorOfT::shear * (rise * absolute(inverse)));
  const float first = t - error, last = t + error;
  const bool decided = edges.min_edge > ray.min_value || edges.max_edge < -ray.min_value;
  const bool nearer = ray.t_min <= first && (any_hit ? last <= nearest.last : last < nearest.first);
  const bool farther = !(ray.t_min <= last && first <= nearest.last);
  if (decided && (nearer || farther)) {
    nearest.first = nearer ? first : nearest.first;
    nearest.last = nearer ? last : nearest.last;
    nearest.reference = nearer ? place : nearest.reference;
    return decided_t;
  }
  // A triangle with several references is met in each of them.
  if (!any_hit && nearest.found() && first_words.w == number_of(triangles[nearest.reference]))
    return decided_t;
  return decided ? first : -FLT_MAX;
}

}  // namespace kerf::cuda
