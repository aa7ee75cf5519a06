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

KERF_CUDA_INLINE Frame frame_of(const Vec3f& d) {
  const float ax = absolute(d.x), ay = absolute(d.y), az = absolute(d.z);
  const std::uint32_t kz = standard_max(ax, ay) > az ? (ax > ay ? 0 : 1) : 2;
  const float dz = kz == 0 ? d.x : kz == 1 ? d.y : d.z;
  const float dx = kz == 0 ? d.y : kz == 1 ? d.z : d.x;
  const float dy = kz == 0 ? d.z : kz == 1 ? d.x : d.y;
  const bool swapped = dz < 0.0f;
  return {kz, swapped, (swapped ? dy : dx) / dz, (swapped ? dx : dy) / dz, dz};
}

/// A frame without the change of places, which only turns the signs of all edge functions.
struct Shear {
  std::uint32_t axis_z;
  float x, y;
};

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
};

/// How far t may be off in single precision, in units of 2^-24 of the distance to the far side of the scene:
/// 15 for the weights, a reciprocal and the mean, and 6 for the shear, both with room. See `LeafConstants` of
/// the library.
struct ErrorOfT {
  static constexpr float mean = 18.0f, shear = 8.0f;
};

struct ScaledRay {
  float direction[3], t_min, t_max;
};

// A ray whose direction is very long or very short is scaled by a power of two, so that neither distances nor
// inverses overflow.
KERF_CUDA_INLINE bool needs_scaling(float length) {
  constexpr float shortest = 0x1p-8f, longest = 0x1p20f;
  return !(length > shortest && length < longest);
}
// A t of the scaled ray is one of the caller's times this, which makes the largest component of the direction
// one in [1, 2).
KERF_CUDA_INLINE double scale_of(double length) {
  return as_double(as_bits(length) & 0x7ff0000000000000u);
}
// By value, so that no ray has an address and must lie in memory.
KERF_CUDA_NOINLINE ScaledRay rescaled(float x, float y, float z, float t_min, float t_max, double length) {
  const double scale = scale_of(length);
  const double inverse = as_double(0x7fe0000000000000u - as_bits(scale));  // of a power of two: exact
  const double highest = static_cast<double>(FLT_MAX);
  return {{static_cast<float>(x * inverse), static_cast<float>(y * inverse), static_cast<float>(z * inverse)},
          static_cast<float>(standard_max(standard_min(t_min * scale, highest), -highest)),
          static_cast<float>(standard_max(standard_min(t_max * scale, highest), -highest))};
}

KERF_CUDA_INLINE float longest_component(const Vec3f& d) {
  return standard_max(standard_max(absolute(d.x), absolute(d.y)), absolute(d.z));
}

/// The direction as it is traced, with t_min and t_max in lengths of it. False for a ray that can hit
/// nothing: t_max < t_min, something not finite, or a direction of zero.
KERF_CUDA_INLINE bool tame(const Ray& ray, ScaledRay& out) {
  const Vec3f o = ray.origin, d = ray.direction;
  const float length = longest_component(d);
  // Zero times anything infinite or not a number is not a number, which equals nothing.
  const float zero = (0.0f * o.x + 0.0f * o.y) + (0.0f * o.z + 0.0f * d.x) + (0.0f * d.y + 0.0f * d.z);
  if (!((zero == 0.0f) & (ray.t_min <= ray.t_max))) return false;
  out = {{d.x, d.y, d.z}, standard_max(ray.t_min, -FLT_MAX), standard_min(ray.t_max, FLT_MAX)};
  if (needs_scaling(length)) {
    if (!(length > 0.0f)) return false;
    out = rescaled(d.x, d.y, d.z, out.t_min, out.t_max, length);
  }
  return out.t_min <= out.t_max;
}

/// False for a ray that can hit nothing, as in a hierarchy of nothing. `ray` must outlive `out`.
KERF_CUDA_INLINE bool prepare(const Ray& ray, const SceneBounds* bounds, TracedRay& out) {
  ScaledRay scaled{};
  if (bounds == nullptr || !tame(ray, scaled)) return false;
  const SceneBounds scene = *bounds;
  const float o[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const float d[3] = {scaled.direction[0], scaled.direction[1], scaled.direction[2]};
  out.source = &ray;
  out.t_min = scaled.t_min;
  out.t_max = scaled.t_max;

  float distance = 0.0f, coordinate = 0.0f, largest = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    distance = maximum(distance,
                       maximum(absolute(o[axis] - scene.lower[axis]), absolute(o[axis] - scene.upper[axis])));
    coordinate = maximum(coordinate, absolute(o[axis]));
    largest = maximum(largest, absolute(d[axis]));
  }
  const float margin =
      0x1p-24f * (BoxConstants::margin_of_distance * distance + BoxConstants::margin_of_origin * coordinate);
  const float smallest = 0x1p-26f * largest;  // moves the ray by no more than a quarter of a unit of D
  for (int axis = 0; axis < 3; ++axis) {
    out.origin[axis] = o[axis];
    const float positive = near_reciprocal(maximum(absolute(d[axis]), smallest));
    const std::uint32_t sign = as_bits(d[axis]) & 0x80000000u;
    const float inverse = as_float(as_bits(positive) | sign);
    const float product = o[axis] * inverse, grown = margin * positive;
    // Where distances along an axis might leave the range of a float, that axis rules nothing out.
    const bool told = (distance + coordinate) * positive < 0x1p120f;
    out.boxes.forward[axis] = told && sign == 0 ? inverse : 0.0f;
    out.boxes.backward[axis] = told && sign != 0 ? inverse : 0.0f;
    out.boxes.enter[axis] = told ? -product - grown : -FLT_MAX;
    out.boxes.leave[axis] = told ? grown - product : FLT_MAX;
  }

  const Frame frame = frame_of({d[0], d[1], d[2]});
  out.shear = {frame.axis_z, frame.swapped ? frame.sy : frame.sx, frame.swapped ? frame.sx : frame.sy};
  out.inverse_dz = near_reciprocal(frame.dz);
  out.error_unit = 0x1p-24f * distance * absolute(out.inverse_dz);
  out.min_value = distance < 0x1p36f ? 0x1p-60f : as_float(0x7f800000u);
  return true;
}

/// A t of the prepared ray as one of the caller's `ray`.
KERF_CUDA_INLINE float unscaled(const Ray& ray, float t) {
  const float length = longest_component(ray.direction);
  return needs_scaling(length) ? static_cast<float>(t / scale_of(length)) : t;
}

}  // namespace kerf::cuda
