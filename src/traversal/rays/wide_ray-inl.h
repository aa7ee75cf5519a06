// A ray as kernels need it that test many boxes or triangles at once.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_WIDE_RAY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_WIDE_RAY_INL_H
#undef KERF_TRAVERSAL_RAYS_WIDE_RAY_INL_H
#else
#define KERF_TRAVERSAL_RAYS_WIDE_RAY_INL_H
#endif

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <hwy/highway.h>

#include "layout/wide_bvh.hpp"
#include "math/ray_box.hpp"
#include "math/ray_triangle.hpp"
#include "simd/floats-inl.h"
#include "simd/lookup-inl.h"
#include "simd/targets.hpp"
#include "traversal/node-inl.h"
#include "traversal/rays/prepared_ray.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// One number for each of as many boxes as a vector has lanes.
using BoxVector = hn::Vec<NodeFloats::Tag>;

#if KERF_FLOAT_LANES > 1
using FloatTag4 = hn::FixedTag<float, 4>;
using Float4 = hn::Vec<FloatTag4>;
#endif

inline constexpr std::uint32_t bytes_per_row = node_width * sizeof(float);

// Where in a node the planes of entry and of exit begin, in bytes.
struct PlaneRows {
  std::uint32_t near[3], far[3];
};
// By octant: bit a says whether rays go the negative way along axis a.
constexpr std::array<PlaneRows, 8> plane_rows = [] {
  std::array<PlaneRows, 8> rows{};
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t negative = (octant >> axis) & 1;
      rows[octant].near[axis] = (2 * axis + negative) * bytes_per_row;
      rows[octant].far[axis] = (2 * axis + 1 - negative) * bytes_per_row;
    }
  }
  return rows;
}();

// The axes of a shear (see `RayShear`), and the bytes of x, y, z and another number that are the numbers
// along these axes.
struct ShearAxes {
  alignas(16) std::uint8_t byte[16];
  std::array<std::uint32_t, 3> axis;
};
// By twice the axis along which the direction is largest, and one more where it is negative there.
constexpr std::array<ShearAxes, 6> shear_axes = [] {
  std::array<ShearAxes, 6> table{};
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t kz = i / 2, negative = i % 2;
    ShearAxes& axes = table[i];
    axes.axis[0] = (kz + 1 + negative) % 3;
    axes.axis[1] = (kz + 2 - negative) % 3;
    axes.axis[2] = kz;
    for (std::uint32_t k = 0; k < 16; ++k)
      axes.byte[k] = static_cast<std::uint8_t>(4 * (k < 12 ? axes.axis[k / 4] : 3) + k % 4);
  }
  return table;
}();

// The values of `RayBoxes` and `RayShear`, each to be broadcast from memory where it is needed. Two cache
// lines.
struct alignas(64) WideRay {
  alignas(16) float inverse[4], enter[4], leave[4];  // of RayBoxes, along x, y, z
  PlaneRows rows;
  float t_min = 0.0f;
  std::uint32_t octant;  // see `plane_rows`

  alignas(16) float origin[4];        // along the axes of the shear
  alignas(16) float shear[4];         // sx, sy, inverse_dz, and `error`
  std::array<std::uint32_t, 3> axis;  // of the shear
  float min_value;  // of SinglePrecision; infinite where results might leave the range of a float

  HWY_INLINE float sx() const { return shear[0]; }
  HWY_INLINE float sy() const { return shear[1]; }
  HWY_INLINE float inverse_dz() const { return shear[2]; }
  // Of t, for each unit of 2^-24 of the distance to the far side of the scene.
  HWY_INLINE float error() const { return shear[3]; }
};

// From which magnitude on an edge function is decided in single precision, for a scene whose far side lies at
// `distance` along the axes: with coordinates below 2^36 no determinant and no t comes near
// `SinglePrecision::max_value`.
HWY_INLINE float min_value(float distance) {
  return distance < 0x1p36f ? SinglePrecision::min_value : std::numeric_limits<float>::infinity();
}

// Whether a ray from which the far side of the scene lies at `distance` has to be scaled, see `PreparedRay`.
HWY_INLINE bool is_far(float distance, const WideBvh& bvh) {
  return !(distance + bvh.largest_coordinate < PreparedRay::far);
}

#if KERF_FLOAT_LANES == 1
template <bool prepared = false>
HWY_INLINE bool set_up(const Ray& ray, const WideBvh& bvh, WideRay& out) {
  out = {};
  if constexpr (!prepared) {
    const PreparedRay wanted(ray);
    if (wanted.scale != 1.0 || (!wanted.valid() && ray.t_min <= ray.t_max)) return false;
  }
  const float o[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const RayBoxes boxes(ray.origin, ray.direction, bvh.bounds);
  if (!prepared && is_far(boxes.distance, bvh)) return false;
  const RayShear shear(ray.direction);
  const int axes[3] = {shear.kx, shear.ky, shear.kz};
  out.t_min = ray.t_min;
  std::uint32_t octant = 0;
  for (int i = 0; i < 3; ++i) {
    out.inverse[i] = boxes.inverse[i];
    out.enter[i] = boxes.enter[i];
    out.leave[i] = boxes.leave[i];
    octant |= static_cast<unsigned>(std::signbit(boxes.inverse[i])) << i;
    out.origin[i] = o[axes[i]];
  }
  out.octant = octant;
  out.rows = plane_rows[octant];
  for (std::size_t i = 0; i < 3; ++i) out.axis[i] = static_cast<std::uint32_t>(axes[i]);
  out.shear[0] = shear.sx;
  out.shear[1] = shear.sy;
  out.shear[2] = shear.inverse_dz;
  out.shear[3] = 0x1p-24f * boxes.distance * std::abs(out.inverse_dz());
  out.min_value = min_value(boxes.distance);
  return true;
}
#else
// Three floats, the last of them twice. Each is loaded for itself: a caller has most often just written them
// one by one, and what is loaded at once would have to wait until these stores are done.
HWY_INLINE Float4 load_each(const float* floats) {
  const FloatTag4 tag;
  const Float4 x = hn::Set(tag, floats[0]), y = hn::Set(tag, floats[1]), z = hn::Set(tag, floats[2]);
  return hn::ConcatLowerLower(tag, z, hn::InterleaveLower(tag, x, y));
}
// Of floats that are not negative.
HWY_INLINE Float4 largest_of_three(Float4 v) {
  return larger_as_bits(larger_as_bits(hn::Broadcast<0>(v), hn::Broadcast<1>(v)), hn::Broadcast<2>(v));
}
HWY_INLINE std::uint32_t three_bits(hn::Mask<FloatTag4> mask) {
  return bits(FloatTag4(), mask) & 7u;
}

// The margin of `RayBoxes`, or more: no coordinate of the origin exceeds distance + largest_coordinate.
template <class Tag>
HWY_INLINE hn::Vec<Tag> boxes_margin(Tag tag, hn::Vec<Tag> distance, const WideBvh& bvh) {
  constexpr float unit = 0x1p-24f;
  return hn::MulAdd(distance,
                    hn::Set(tag, unit * (RayBoxes::margin_of_distance + RayBoxes::margin_of_origin)),
                    hn::Set(tag, unit * RayBoxes::margin_of_origin * bvh.largest_coordinate));
}

// False for a ray that `PreparedRay` has to scale or to refuse, unless it has done so. The shear is that of
// `RayShear` to the last bit. The margin of boxes may differ, which changes no hit.
template <bool prepared = false>
HWY_INLINE bool set_up(const Ray& ray, const WideBvh& bvh, WideRay& out) {
  const FloatTag4 tag;
  const float* origin = &ray.origin.x;
  const float* direction = &ray.direction.x;
  const Float4 o = load_each(origin), d = load_each(direction);
  const Float4 absolute = hn::Abs(d);
  const Float4 largest = largest_of_three(absolute);
  const float length = hn::GetLane(largest);
  // The bits of infinities and of what is no number are larger than those of numbers.
  if (!prepared && !(length > PreparedRay::shortest && length < PreparedRay::longest)) return false;

  const Float4 distance =
      largest_of_three(larger_as_bits(hn::Abs(hn::Sub(o, hn::LoadU(tag, &bvh.bounds.lower.x))),
                                      hn::Abs(hn::Sub(o, hn::LoadU(tag, &bvh.bounds.upper.x)))));
  if (!prepared && HWY_UNLIKELY(is_far(hn::GetLane(distance), bvh))) return false;
  const Float4 margin = boxes_margin(tag, distance, bvh);
  // The least component of the shortest direction that is not scaled, so that the division need not wait for
  // the largest component.
  Float4 least = hn::Set(tag, RayBoxes::least_part * PreparedRay::shortest);
  if constexpr (prepared) least = hn::Mul(largest, hn::Set(tag, RayBoxes::least_part));
  const Float4 positive = hn::Div(hn::Set(tag, 1.0f), larger_as_bits(absolute, least));
  const Float4 inverse = hn::Or(positive, hn::And(d, hn::SignBit(tag)));
  const Float4 grown = hn::Mul(margin, positive);
  hn::Store(inverse, tag, out.inverse);
  hn::Store(hn::NegMulSub(o, inverse, grown), tag, out.enter);
  hn::Store(hn::NegMulAdd(o, inverse, grown), tag, out.leave);
  out.t_min = ray.t_min;
  const hn::RebindToSigned<FloatTag4> integers;
  out.octant = three_bits(hn::MaskFromVec(hn::BitCast(tag, hn::BroadcastSignBit(hn::BitCast(integers, d)))));
  out.rows = plane_rows[out.octant];

  const auto kz = static_cast<std::uint32_t>(std::bit_width(three_bits(hn::Eq(absolute, largest)))) - 1;
  const ShearAxes& axes = shear_axes[2 * kz + ((out.octant >> kz) & 1)];
  out.axis = axes.axis;
  const auto along_axes = [&](Float4 v) HWY_ATTR { return lookup_bytes(v, axes.byte); };
  hn::Store(along_axes(o), tag, out.origin);
  const Float4 turned = along_axes(d);
  const Float4 quotients =
      hn::Div(hn::ConcatUpperLower(tag, hn::Set(tag, 1.0f), turned), hn::Broadcast<2>(turned));
  hn::Store(quotients, tag, out.shear);
  out.shear[3] = 0x1p-24f * hn::GetLane(distance) * std::abs(hn::GetLane(hn::Broadcast<2>(quotients)));
  out.min_value = min_value(hn::GetLane(distance));
  return true;
}
#endif

// The same for a ray of which `meet_boxes` may compare numbers as integers: t_min must not be negative, nor
// -0.
HWY_INLINE bool set_up_forward(const Ray& ray, const WideBvh& bvh, WideRay& out) {
  return !std::signbit(ray.t_min) && set_up(ray, bvh, out);
}

// What a node step reads at every node, in registers. `WideRay` itself may stand in for it where a ray has a
// step only now and then.
struct NodeConstants {
  BoxVector inverse[3], enter[3], leave[3], t_min;
  std::size_t near[3], far[3];  // of PlaneRows

  HWY_INLINE explicit NodeConstants(const WideRay& ray) : t_min(hn::Set(NodeFloats::Tag(), ray.t_min)) {
    const NodeFloats::Tag tag;
    const PlaneRows& rows = plane_rows[ray.octant];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      inverse[axis] = hn::Set(tag, ray.inverse[axis]);
      enter[axis] = hn::Set(tag, ray.enter[axis]);
      leave[axis] = hn::Set(tag, ray.leave[axis]);
      near[axis] = rows.near[axis];
      far[axis] = rows.far[axis];
    }
  }
};

// As many triangles of a leaf are tested at once.
inline constexpr std::size_t leaf_group = vector_lanes;
using LeafFloats = Floats<leaf_group>;

// What a leaf test reads at every leaf.
struct LeafConstants {
  LeafFloats origin[3], sx, sy, inverse_dz, min_value;
  LeafFloats error_of_mean, error_of_shear;  // of t

  // In units of 2^-24 of the distance to the far side of the scene: 13 for weights and mean as in the table
  // of `RayBoxes`, and 6 for the shear, both with room.
  static constexpr float mean_error = 16.0f, shear_error = 8.0f;

  std::size_t axis[3];
  float t_min;

  HWY_INLINE explicit LeafConstants(const WideRay& ray)
      : sx(broadcast<leaf_group>(ray.sx())),
        sy(broadcast<leaf_group>(ray.sy())),
        inverse_dz(broadcast<leaf_group>(ray.inverse_dz())),
        min_value(broadcast<leaf_group>(ray.min_value)),
        error_of_mean(broadcast<leaf_group>(mean_error * ray.error())),
        error_of_shear(broadcast<leaf_group>(shear_error * ray.error())),
        t_min(ray.t_min) {
    for (std::size_t i = 0; i < 3; ++i) {
      origin[i] = broadcast<leaf_group>(ray.origin[i]);
      axis[i] = ray.axis[i];
    }
  }
};

// `NodeConstants` have the rows themselves.
HWY_INLINE const PlaneRows& rows_of(const WideRay& ray) {
  return ray.rows;
}
HWY_INLINE const NodeConstants& rows_of(const NodeConstants& constants) {
  return constants;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
