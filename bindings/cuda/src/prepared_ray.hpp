// A ray as the traversals need it: tame, with the constants of its box tests and of its triangle tests. The
// library's `PreparedRay`, `RayBoxes` and `RayShear` once more, operation by operation.
#pragma once

#include <cfloat>

#include <kerf/ray.hpp>
#include <kerf/vec.hpp>

#include "arithmetic.hpp"

namespace kerf::cuda {

/// A box around all triangles, in memory of the device: kernels that move corners write it.
struct alignas(32) SceneBounds {
  float lower[3], upper[3];
};

/// Along each axis the ray enters at `lower * forward + upper * backward + enter` and leaves at `upper *
/// forward + lower * backward + leave`: of the two factors one is the inverse of the direction and the other
/// 0, so that no plane must be chosen. `enter` and `leave` carry the origin and the margin by which boxes are
/// in effect grown. In units of 2^-24, with D the largest distance
/// along an axis from the origin to the scene's far side and O the origin's largest coordinate:
///
///     the shear of a triangle's vertices      6 D     (a difference, a quotient, a product, a difference)
///     inverse, the plane's distance           3 D
///     the triangle's t                       144 D     (24 times the shear)
///     a node's corner, then its planes        2 D     (fused, each rounded once)
///     origin times inverse, the constants             2 O
///     directions raised to the minimum        1/4 D
struct BoxConstants {
  static constexpr float margin_of_distance = 160.0f, margin_of_origin = 4.0f;

  float forward[3], backward[3], enter[3], leave[3];

  /// Whether the ray meets the box in [t_min, t_max], and from where on.
  KERF_CUDA_INLINE bool meet(const Words4& xy, std::uint32_t lower_z, std::uint32_t upper_z, float t_min,
                             float t_max, float& entered) const {
    const float first_x = entry(0, as_float(xy.x), as_float(xy.y)),
                first_y = entry(1, as_float(xy.z), as_float(xy.w)),
                first_z = entry(2, as_float(lower_z), as_float(upper_z));
    const float last_x = exit(0, as_float(xy.x), as_float(xy.y)),
                last_y = exit(1, as_float(xy.z), as_float(xy.w)),
                last_z = exit(2, as_float(lower_z), as_float(upper_z));
    entered = maximum(largest_of(first_x, first_y, first_z), t_min);
    return entered <= minimum(smallest_of(last_x, last_y, last_z), t_max);
  }

 private:
  // The product with 0 is exact, so that each is rounded once.
  KERF_CUDA_INLINE float entry(int axis, float lower, float upper) const {
    return fused_multiply_add(lower, forward[axis], fused_multiply_add(upper, backward[axis], enter[axis]));
  }
  KERF_CUDA_INLINE float exit(int axis, float lower, float upper) const {
    return fused_multiply_add(upper, forward[axis], fused_multiply_add(lower, backward[axis], leave[axis]));
  }
};

/// A ray's frame, see `RayShear`: the axis on which its direction is largest becomes z.
struct Frame {
  std::uint32_t axis_z;  // 0 to 2
  bool swapped;          // x and y change places, where the direction is negative on that axis
  float sx, sy, dz;
};

/// A frame without the change of places, which only turns the signs of all edge functions.
struct Shear {
  std::uint32_t axis_z;
  float x, y;
};

// The axis along which the direction is largest, and its components from there on.
struct TurnedDirection {
  std::uint32_t axis_z;
  float x, y, z;
};
KERF_CUDA_INLINE TurnedDirection turned(const Vec3f& d) {
  const float ax = absolute(d.x), ay = absolute(d.y), az = absolute(d.z);
  const std::uint32_t k = maximum(ax, ay) > az ? (ax > ay ? 0 : 1) : 2;
  return {k, one_of(k, d.y, d.z, d.x), one_of(k, d.z, d.x, d.y), one_of(k, d.x, d.y, d.z)};
}
KERF_CUDA_INLINE Frame frame_of(const Vec3f& direction) {
  const TurnedDirection d = turned(direction);
  const bool swapped = d.z < 0.0f;
  return {d.axis_z, swapped, (swapped ? d.y : d.x) / d.z, (swapped ? d.x : d.y) / d.z, d.z};
}

struct TracedRay {
  const Ray* source;  // as the caller gave it
  float origin[3];
  float t_min, t_max;
  BoxConstants boxes;
  Shear shear;
  float inverse_dz;
  float error_unit;  // see `ErrorOfT`
  float min_value;   // of an edge function that single precision decides; infinite for a scene so large that
                     // results might leave the range of a float
  bool is_wider;     // the range holds more than the caller's, see `has_subnormal_limit`

  // Whether the ray may be traced with another direction than the caller's, see `needs_scaling`.
  KERF_CUDA_INLINE bool may_be_far() const { return min_value > FLT_MAX; }
};

/// How far t may be off in single precision, in units of 2^-24 of the distance to the far side of the scene:
/// 15 for the weights, a reciprocal and the mean, and 6 for the shear, both with room. See `LeafConstants` of
/// the library.
struct ErrorOfT {
  static constexpr float mean = 18.0f, shear = 8.0f;
};

/// The largest distance along an axis to the far side of the scene.
KERF_CUDA_INLINE float far_side(const Vec3f& origin, const SceneBounds& scene) {
  const float o[3] = {origin.x, origin.y, origin.z};
  float distance = 0.0f;
  for (int axis = 0; axis < 3; ++axis)
    distance = maximum(distance,
                       maximum(absolute(o[axis] - scene.lower[axis]), absolute(o[axis] - scene.upper[axis])));
  return distance;
}
KERF_CUDA_INLINE float largest_coordinate(const SceneBounds& scene) {
  float largest = 0.0f;
  for (int axis = 0; axis < 3; ++axis)
    largest = maximum(largest, maximum(absolute(scene.lower[axis]), absolute(scene.upper[axis])));
  return largest;
}
/// Whether every direction is scaled, so that quotients of coordinates and of its components do not overflow:
/// `PreparedRay::far` of the library.
KERF_CUDA_INLINE bool is_far(float distance, const SceneBounds& scene) {
  return !(distance + largest_coordinate(scene) < 0x1p90f);
}
KERF_CUDA_INLINE bool is_far(const Ray& ray, const SceneBounds& scene) {
  return is_far(far_side(ray.origin, scene), scene);
}

KERF_CUDA_INLINE float longest_component(const Vec3f& d) {
  return maximum(maximum(absolute(d.x), absolute(d.y)), absolute(d.z));
}
/// Whether a ray is traced with a direction that was scaled by a power of two: one that is very long or very
/// short, so that neither distances nor inverses overflow.
KERF_CUDA_INLINE bool needs_scaling(const Vec3f& direction, bool far) {
  constexpr float shortest = 0x1p-8f, longest = 0x1p20f;
  const float length = longest_component(direction);
  return far || !(length > shortest && length < longest);
}
/// A t of the scaled ray is one of the caller's times this, which makes the largest component of the
/// direction one in [1, 2), or in [2^26, 2^27) of a far ray.
KERF_CUDA_INLINE double scale_of(const Vec3f& direction, bool far) {
  if (!needs_scaling(direction, far)) return 1.0;
  const double power =
      as_double(as_bits(static_cast<double>(longest_component(direction))) & 0x7ff0000000000000u);
  return far ? power * 0x1p-26 : power;
}

/// The direction as it is traced, with t_min and t_max in lengths of it.
struct ScaledRay {
  float direction[3], t_min, t_max;
};

KERF_CUDA_INLINE float scaled_limit(double t, double scale) {
  const double highest = static_cast<double>(FLT_MAX);
  return static_cast<float>(standard_max(standard_min(t * scale, highest), -highest));
}
/// Whether a limit of the caller's range may be one to which several t of the scaled ray are rounded.
KERF_CUDA_INLINE bool has_subnormal_limit(const Ray& ray, bool far) {
  constexpr float smallest_exact = 0x1p-125f;
  if (!needs_scaling(ray.direction, far)) return false;
  return (ray.t_min != 0.0f && absolute(ray.t_min) < smallest_exact) || absolute(ray.t_max) < smallest_exact;
}

KERF_CUDA_INLINE bool is_finite(const Vec3f& o, const Vec3f& d) {
  // Zero times anything infinite or not a number is not a number, which equals nothing.
  const float numbers[] = {o.x, o.y, o.z, d.x, d.y, d.z};
  float zero = 0.0f;
  for (int i = 0; i < 6; ++i) zero = fused_multiply_add(0.0f, numbers[i], zero);
  return zero == 0.0f;
}

/// Whether a ray may be traced as it is: it can hit something, and is neither scaled nor far.
KERF_CUDA_INLINE bool is_plain(const Ray& ray, bool far) {
  return is_finite(ray.origin, ray.direction) && ray.t_min <= ray.t_max && !needs_scaling(ray.direction, far);
}

/// A ray of which `is_plain` is not true. By value, so that no ray has an address and must lie in memory.
/// t_max < t_min for one that can hit nothing: t_max < t_min, something not finite, or a direction of zero.
KERF_CUDA_NOINLINE ScaledRay tamed(Vec3f o, Vec3f d, float t_min, float t_max, bool far) {
  constexpr double half_step = 0x1p-150;
  if (!(is_finite(o, d) && t_min <= t_max && longest_component(d) > 0.0f))
    return {{1.0f, 0.0f, 0.0f}, 0.0f, -1.0f};
  const float first = maximum(t_min, -FLT_MAX), last = minimum(t_max, FLT_MAX);
  if (!needs_scaling(d, far)) return {{d.x, d.y, d.z}, first, last};
  const double scale = scale_of(d, far);
  const double inverse = as_double(0x7fe0000000000000u - as_bits(scale));  // of a power of two: exact
  // A limit that is no normal number may have been rounded to: the range holds every t that rounds into it.
  return {{static_cast<float>(d.x * inverse), static_cast<float>(d.y * inverse),
           static_cast<float>(d.z * inverse)},
          scaled_limit(first == 0.0f ? 0.0 : first - half_step, scale),
          scaled_limit(last + half_step, scale)};
}

/// A ray of which `is_plain` is true.
KERF_CUDA_INLINE ScaledRay plain(const Ray& ray) {
  return {{ray.direction.x, ray.direction.y, ray.direction.z},
          maximum(ray.t_min, -FLT_MAX),
          minimum(ray.t_max, FLT_MAX)};
}

KERF_CUDA_INLINE ScaledRay scaled_ray(const Ray& ray, bool far) {
  return is_plain(ray, far) ? plain(ray) : tamed(ray.origin, ray.direction, ray.t_min, ray.t_max, far);
}

/// The caller's ray, read by wide loads where it is aligned for them, as all arrays of CUDA are.
KERF_CUDA_INLINE Ray read(const Ray* ray) {
#ifdef __CUDA_ARCH__
  if ((reinterpret_cast<std::uintptr_t>(ray) & 15) == 0) {
    static_assert(sizeof(Ray) == 32);
    const float4 first = *reinterpret_cast<const float4*>(ray),
                 second = reinterpret_cast<const float4*>(ray)[1];
    return {{first.x, first.y, first.z}, {first.w, second.x, second.y}, second.z, second.w};
  }
#endif
  return *ray;
}

/// False for a ray that can hit nothing, as in a hierarchy of nothing. `source` must outlive `out`.
KERF_CUDA_INLINE bool prepare(const Ray* source, const SceneBounds* bounds, TracedRay& out) {
  if (bounds == nullptr) return false;
  const Ray ray = read(source);
  const SceneBounds scene = *bounds;
  const float distance = far_side(ray.origin, scene);
  const bool far = is_far(distance, scene);
  // `scaled_ray`, with what only rays that are not plain are asked in the same branch: apart, it adds eight
  // instructions to every ray.
  ScaledRay scaled = plain(ray);
  out.is_wider = false;
  if (!is_plain(ray, far)) {
    scaled = tamed(ray.origin, ray.direction, ray.t_min, ray.t_max, far);
    out.is_wider = has_subnormal_limit(ray, far);
  }
  if (!(scaled.t_min <= scaled.t_max)) return false;
  const float o[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const Vec3f d{scaled.direction[0], scaled.direction[1], scaled.direction[2]};
  out.source = source;
  out.t_min = scaled.t_min;
  out.t_max = scaled.t_max;

  // No coordinate of the origin exceeds distance and largest coordinate of the scene together.
  const float margin =
      0x1p-24f * fused_multiply_add(BoxConstants::margin_of_distance + BoxConstants::margin_of_origin,
                                    distance, BoxConstants::margin_of_origin * largest_coordinate(scene));
  // Moves the ray by no more than a quarter of a unit of D.
  const float smallest = 0x1p-26f * longest_component(d);
  for (int axis = 0; axis < 3; ++axis) {
    out.origin[axis] = o[axis];
    const float positive = near_reciprocal(maximum(absolute(scaled.direction[axis]), smallest));
    const bool backward = scaled.direction[axis] < 0.0f;
    const float inverse = backward ? -positive : positive;
    const float grown = margin * positive;
    out.boxes.forward[axis] = backward ? 0.0f : inverse;
    out.boxes.backward[axis] = backward ? inverse : 0.0f;
    out.boxes.enter[axis] = fused_multiply_add(-o[axis], inverse, -grown);
    out.boxes.leave[axis] = fused_multiply_add(-o[axis], inverse, grown);
  }

  const TurnedDirection along = turned(d);
  const Quotients quotients = divide_both(along.x, along.y, along.z);
  out.shear = {along.axis_z, quotients.a, quotients.b};
  out.inverse_dz = quotients.inverse;
  out.error_unit = 0x1p-24f * distance * absolute(out.inverse_dz);
  out.min_value = distance < 0x1p36f ? 0x1p-60f : as_float(0x7f800000u);
  return true;
}

}  // namespace kerf::cuda
