// Coherent rays, traced as a packet.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_PACKET_INL_H
#undef KERF_TRAVERSAL_RAYS_PACKET_INL_H
#else
#define KERF_TRAVERSAL_RAYS_PACKET_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include <hwy/highway.h>

#include "math/ray_triangle.hpp"
#include "simd/floats-inl.h"
#include "simd/targets.hpp"
#include "traversal/rays/leaf_test-inl.h"
#include "traversal/rays/node_step-inl.h"
#include "traversal/rays/wide_ray-inl.h"

// Whether there are packets: with shorter vectors they are slower than single rays.
#define KERF_PACKETS (KERF_FLOAT_LANES >= 8 && HWY_NATIVE_FMA)
#if KERF_PACKETS
HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Writes the slots of the children that are met, from far to near, and returns their number.
HWY_INLINE std::uint32_t far_to_near(const WideNode& node, const Spans& spans, std::uint32_t octant,
                                     std::uint32_t (&out)[wide_node_children]) {
  const std::uint32_t met = less_or_equal(spans.first, spans.last);
  const auto count = static_cast<std::uint32_t>(std::popcount(met));
#if KERF_FLOAT_LANES == 16
  const Float16::Tag floats;
  const hn::RebindToUnsigned<Float16::Tag> integers;
  const auto slots = far_to_near_slots(node, octant);
  const auto float_slots = hn::IndicesFromVec(floats, slots);
  const auto mask = hn::Le(hn::TableLookupLanes(spans.first.vector[0], float_slots),
                           hn::TableLookupLanes(spans.last.vector[0], float_slots));
  hn::StoreU(compress(slots, mask), integers, out);
#else
  MetSlots slots;
  list_met(met, node.order[octant], slots);
  std::copy_n(slots.slot, count, out);
#endif
  return count;
}

// As many rays as a vector has lanes. Their directions lie in one octant, are largest along the same axis and
// differ little. The sixteen boxes of a node are tested against the packet as a whole, in interval arithmetic
// (after Reshetov, Soupikov & Hurley 2005, "Multi-Level Ray Tracing Algorithm"). The boxes that it may meet
// are tested against its rays, one box at a time; so are the triangles of a leaf, one triangle at a time.
template <bool any_hit>
class Packet {
  using Tag = hn::ScalableTag<float>;
  using Bits = hn::RebindToUnsigned<Tag>;
  using V = hn::Vec<Tag>;
  using M = hn::Mask<Tag>;

 public:
  static constexpr std::size_t width = hn::MaxLanes(Tag());

  explicit Packet(const WideBvh& bvh) : bvh_(bvh) {}

  // Takes `width` rays. False if they are not coherent, or if one of them has to be scaled.
  HWY_INLINE bool set(const Ray* rays) {
    const Tag tag;
    V origin[3], direction[3], absolute[3], t_min, t_max;
    gather(rays, origin, direction, t_min, t_max);
    const float d[3] = {rays[0].direction.x, rays[0].direction.y, rays[0].direction.z};
    const V zero = hn::Zero(tag);
    V length2 = zero, along = zero;
    octant_ = 0;
    bool fit = hn::AllTrue(tag, hn::Le(t_min, t_max));
    for (std::size_t a = 0; a < 3; ++a) {
      absolute[a] = hn::Abs(direction[a]);
      length2 = hn::Add(length2, hn::Mul(direction[a], direction[a]));
      along = hn::Add(along, hn::Mul(direction[a], hn::Set(tag, d[a])));
      fit &= hn::AllTrue(tag, hn::Eq(hn::Mul(zero, hn::Add(origin[a], direction[a])), zero));
      const bool negative = std::signbit(d[a]);
      fit &= negative ? hn::AllTrue(tag, is_negative(direction[a]))
                      : hn::AllFalse(tag, is_negative(direction[a]));
      octant_ |= static_cast<std::uint32_t>(negative) << a;
    }
    const V largest = hn::Max(hn::Max(absolute[0], absolute[1]), absolute[2]);
    fit &= hn::AllTrue(tag, hn::And(hn::Lt(hn::Set(tag, PreparedRay::shortest), largest),
                                    hn::Lt(largest, hn::Set(tag, PreparedRay::longest))));
    // The axis of the largest component as in `RayShear`: of several, the last.
    std::size_t kz = 2;
    while (kz > 0 && !hn::AllTrue(tag, hn::Eq(absolute[kz], largest))) {
      fit &= hn::AllFalse(tag, hn::Eq(absolute[kz], largest));
      --kz;
    }
    fit &= hn::AllTrue(tag, hn::Eq(absolute[kz], largest));
    const float length2_first = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    fit &= hn::AllTrue(tag, hn::Le(hn::Mul(length2, hn::Set(tag, min_cosine * min_cosine * length2_first)),
                                   hn::Mul(along, along)));
    if (!fit) return false;

    const float lower[3] = {bvh_.bounds.lower.x, bvh_.bounds.lower.y, bvh_.bounds.lower.z};
    const float upper[3] = {bvh_.bounds.upper.x, bvh_.bounds.upper.y, bvh_.bounds.upper.z};
    V distance = zero;
    float spread = 0.0f, extent = 0.0f;
    for (std::size_t a = 0; a < 3; ++a) {
      distance = hn::Max(distance, hn::Max(hn::Abs(hn::Sub(origin[a], hn::Set(tag, lower[a]))),
                                           hn::Abs(hn::Sub(origin[a], hn::Set(tag, upper[a])))));
      find_range(origin[a], origin_low_[a], origin_high_[a]);
      spread = std::max(spread, origin_high_[a] - origin_low_[a]);
      extent = std::max(extent, upper[a] - lower[a]);
    }
    if (!(spread <= max_spread * extent)) return false;
    const V margin = boxes_margin(tag, distance, bvh_);
    float min_margin, max_margin;
    find_range(hn::Add(margin, margin), min_margin,
               max_margin);  // twice: for the rounding of the interval arithmetic as well
    const V min_component = hn::Mul(largest, hn::Set(tag, 0x1p-26f));
    for (std::size_t a = 0; a < 3; ++a) {
      const V positive = hn::Div(hn::Set(tag, 1.0f), hn::Max(absolute[a], min_component));
      inverse_[a] = hn::CopySign(positive, direction[a]);
      const V product = hn::Mul(origin[a], inverse_[a]), grown = hn::Mul(margin, positive);
      enter_[a] = hn::Sub(hn::Neg(product), grown);
      leave_[a] = hn::Sub(grown, product);
      inverse_low_[a] = hn::GetLane(hn::MinOfLanes(tag, inverse_[a]));
      inverse_high_[a] = hn::GetLane(hn::MaxOfLanes(tag, inverse_[a]));
      origin_low_[a] -= max_margin;
      origin_high_[a] += max_margin;
      const std::size_t negative = (octant_ >> a) & 1;
      near_[a] = (2 * a + negative) * wide_node_children;
      far_[a] = (2 * a + 1 - negative) * wide_node_children;
    }
    const ShearAxes axes = shear_axes[kz][(octant_ >> kz) & 1];
    for (std::size_t a = 0; a < 3; ++a) {
      axis_[a] = axes.axis[a];
      shear_origin_[a] = origin[axes.axis[a]];
    }
    sx_ = hn::Div(direction[axis_[0]], direction[kz]);
    sy_ = hn::Div(direction[axis_[1]], direction[kz]);
    dz_ = direction[kz];
    inverse_dz_ = hn::Div(hn::Set(tag, 1.0f), dz_);
    t_min_ = hn::Max(t_min, zero);
    t_best_ = hn::Min(t_max, hn::Set(tag, std::numeric_limits<float>::max()));
    hn::Store(zero, tag, u_);
    hn::Store(zero, tag, v_);
    primitive_ = hn::Set(Bits(), invalid_id);
    float unused;
    find_range(t_min_, t_first_, unused);
    find_range(t_best_, unused, t_last_);
    return true;
  }

  // Traces the rays that were set. `finish(lane, hit)` is called once per ray.
  template <class Finish>
  HWY_INLINE void run(Finish&& finish) {
    const Tag tag;
    visits_ = active_ = 0;
    std::size_t depth = 0;
    open(0, hn::MaskFromVec(hn::BitCast(tag, hn::Set(Bits(), ~0u))), depth);
    while (depth > 0) {
      const Entry& entry = stack_[--depth];
      const ChildLink link(entry.link);
      const M active = hn::And(hn::Le(hn::Load(tag, entry.t), t_best_), hn::LoadMaskBits(tag, entry.rays));
      if (hn::AllFalse(tag, active)) continue;
      ++visits_;
      active_ += hn::CountTrue(tag, active);
      if (link.is_leaf()) {
        test(link, active);
      } else {
        open(link.node(), active, depth);
      }
    }
    alignas(64) float t[width];
    alignas(64) std::uint32_t primitive[width];
    const M hit = hn::RebindMask(tag, hn::Ne(primitive_, hn::Set(Bits(), invalid_id)));
    hn::Store(hn::IfThenElse(hit, t_best_, hn::Set(tag, std::numeric_limits<float>::infinity())), tag, t);
    hn::Store(primitive_, Bits(), primitive);
    for (std::size_t i = 0; i < width; ++i) {
      finish(i, Hit{.t = t[i], .u = u_[i], .v = v_[i], .primitive = primitive[i]});
    }
  }

  // Whether enough rays of the last packet visited the same nodes for it to be worth while.
  bool was_coherent() const { return active_ >= min_active * visits_; }

 private:
  // Rays with a larger angle between them soon visit different nodes (primary rays of neighbouring pixels are
  // within 3 degrees).
  static constexpr float min_cosine = 0.966f;
  static constexpr float max_spread = 0x1p-6f;  // of origins, in extents of the scene

  // A step of the packet costs about as much as the steps of this many interleaved rays.
  static constexpr std::uint64_t min_active = 4;

  struct alignas(64) Entry {
    float t[width];
    std::uint32_t link;
    std::uint8_t rays[8];  // a bit for each ray that enters
  };

  // A ray is eight floats: ox oy oz dx dy dz t_min t_max.
  static HWY_INLINE void gather(const Ray* rays, V (&origin)[3], V (&direction)[3], V& t_min, V& t_max) {
    static_assert(sizeof(Ray) == 8 * sizeof(float));
    const Tag tag;
    const float* floats = &rays[0].origin.x;
    // Of the first and the second half of the rays: a[i] has floats i and i + 4 of each ray, alternating.
    V a[4], b[4];
    hn::LoadInterleaved4(tag, floats, a[0], a[1], a[2], a[3]);
    hn::LoadInterleaved4(tag, floats + 4 * width, b[0], b[1], b[2], b[3]);
    for (int i = 0; i < 3; ++i) origin[i] = hn::ConcatEven(tag, b[i], a[i]);
    direction[0] = hn::ConcatEven(tag, b[3], a[3]);
    direction[1] = hn::ConcatOdd(tag, b[0], a[0]);
    direction[2] = hn::ConcatOdd(tag, b[1], a[1]);
    t_min = hn::ConcatOdd(tag, b[2], a[2]);
    t_max = hn::ConcatOdd(tag, b[3], a[3]);
  }

  static HWY_INLINE M is_negative(V v) {
    const hn::RebindToSigned<Tag> integers;
    return hn::MaskFromVec(hn::BitCast(Tag(), hn::BroadcastSignBit(hn::BitCast(integers, v))));
  }

  // The smallest and the largest lane. Most often all lanes are the same, as for origins of primary rays.
  static HWY_INLINE void find_range(V v, float& low, float& high) {
    const Tag tag;
    low = high = hn::GetLane(v);
    if (hn::AllTrue(tag, hn::Eq(v, hn::Set(tag, low)))) return;
    low = hn::GetLane(hn::MinOfLanes(tag, v));
    high = hn::GetLane(hn::MaxOfLanes(tag, v));
  }

  // Pushes the children of a node, the nearest last.
  HWY_INLINE void open(std::uint32_t index, M active, std::size_t& depth) {
    const Tag tag;
    const WideNode& node = bvh_.nodes[index];
    const float* planes = &node.planes[0][0][0];
    Float16 first = broadcast<16>(t_first_), last = broadcast<16>(t_last_);
    for (std::size_t a = 0; a < 3; ++a) {
      const bool negative = (octant_ >> a) & 1;
      const Float16 low = broadcast<16>(inverse_low_[a]), high = broadcast<16>(inverse_high_[a]);
      const Float16 near =
          load<16>(planes + near_[a]) - broadcast<16>(negative ? origin_low_[a] : origin_high_[a]);
      const Float16 far =
          load<16>(planes + far_[a]) - broadcast<16>(negative ? origin_high_[a] : origin_low_[a]);
      first = maximum(first, minimum(near * low, near * high));
      last = minimum(last, maximum(far * low, far * high));
    }
    std::uint32_t slots_met[wide_node_children];
    const std::uint32_t met = far_to_near(node, {first, last}, octant_, slots_met);
    for (std::uint32_t i = 0; i < met; ++i) {
      const std::uint32_t slot = slots_met[i];
      const auto plane = [&](std::size_t from) HWY_ATTR { return hn::Set(tag, planes[from + slot]); };
      const V t = hn::Max(hn::Max(hn::MulAdd(plane(near_[0]), inverse_[0], enter_[0]),
                                  hn::MulAdd(plane(near_[1]), inverse_[1], enter_[1])),
                          hn::Max(hn::MulAdd(plane(near_[2]), inverse_[2], enter_[2]), t_min_));
      const V end = hn::Min(hn::Min(hn::MulAdd(plane(far_[0]), inverse_[0], leave_[0]),
                                    hn::MulAdd(plane(far_[1]), inverse_[1], leave_[1])),
                            hn::Min(hn::MulAdd(plane(far_[2]), inverse_[2], leave_[2]), t_best_));
      const M in = hn::And(hn::Le(t, end), active);
      if (hn::AllFalse(tag, in)) continue;
      Entry& entry = stack_[depth++];
      hn::Store(t, tag, entry.t);
      hn::StoreMaskBits(tag, in, entry.rays);
      entry.link = node.children[slot].bits();
    }
  }

  struct Corner {
    V x, y, z;
  };
  HWY_INLINE Corner shear_corner(const float* rows, std::size_t count) const {
    const Tag tag;
    const V z = hn::Sub(hn::Set(tag, rows[axis_[2] * count]), shear_origin_[2]);
    const V x = hn::Sub(hn::Set(tag, rows[axis_[0] * count]), shear_origin_[0]);
    const V y = hn::Sub(hn::Set(tag, rows[axis_[1] * count]), shear_origin_[1]);
    return {hn::Sub(x, hn::Mul(sx_, z)), hn::Sub(y, hn::Mul(sy_, z)), z};
  }

  // The operations of `intersect_triangle`, in its order, for each triangle of a leaf and the active rays.
  HWY_INLINE void test(ChildLink leaf, M active) {
    const Tag tag;
    const std::uint32_t count = leaf.count();
    const std::uint32_t* words = bvh_.leaves.data() + words_per_triangle * leaf.first();
    bool changed = false;
    for (std::uint32_t i = 0; i < count; ++i) {
      const float* rows = reinterpret_cast<const float*>(words) + i;
      const Corner a = shear_corner(rows, count), b = shear_corner(rows + 3 * count, count),
                   c = shear_corner(rows + 6 * count, count);
      const V u = difference_of_products(c.x, b.y, c.y, b.x), v = difference_of_products(a.x, c.y, a.y, c.x),
              w = difference_of_products(b.x, a.y, b.y, a.x);
      const V min_edge = hn::Min(hn::Min(u, v), w), max_edge = hn::Max(hn::Max(u, v), w);
      const M differ = hn::And(hn::Lt(min_edge, hn::Set(tag, -SinglePrecision::min_sign)),
                               hn::Lt(hn::Set(tag, SinglePrecision::min_sign), max_edge));
      const M candidates = hn::AndNot(differ, active);
      if (hn::AllFalse(tag, candidates)) continue;

      const std::uint32_t primitive = words[9 * count + i];
      const V determinant = hn::Add(hn::Add(u, v), w);
      const V inverse = hn::Div(hn::Set(tag, 1.0f), determinant);
      const V z = hn::Add(hn::Add(hn::Mul(u, a.z), hn::Mul(v, b.z)), hn::Mul(w, c.z));
      const V t = hn::Mul(hn::Mul(z, inverse), inverse_dz_);
      const V limit = hn::Set(tag, SinglePrecision::max_value);
      const M large_enough = hn::Or(hn::Lt(hn::Set(tag, SinglePrecision::min_value), min_edge),
                                    hn::Lt(max_edge, hn::Set(tag, -SinglePrecision::min_value)));
      const M small_enough = hn::And(hn::Lt(hn::Abs(determinant), limit), hn::Lt(hn::Abs(t), limit));
      const M trusted = hn::And(candidates, hn::And(large_enough, small_enough));
      changed |= keep_nearer(t, hn::Mul(v, inverse), hn::Mul(w, inverse), primitive, trusted);
      const M others = hn::AndNot(trusted, candidates);
      if (HWY_UNLIKELY(!hn::AllFalse(tag, others))) {
        const Corner corners[] = {a, b, c};
        changed |= test_exactly(corners, others, primitive);
      }
    }
    if (changed) t_last_ = hn::GetLane(hn::MaxOfLanes(tag, t_best_));
  }

  HWY_INLINE bool keep_nearer(V t, V u, V v, std::uint32_t primitive, M which) {
    const Tag tag;
    const V id = hn::BitCast(tag, hn::Set(Bits(), primitive));
    const M lower = hn::RebindMask(tag, hn::Lt(hn::Set(Bits(), primitive), primitive_));
    M nearer = hn::Or(hn::Lt(t, t_best_), hn::And(hn::Eq(t, t_best_), lower));
    nearer = hn::And(hn::And(nearer, hn::Ge(t, t_min_)), which);
    if (hn::AllFalse(tag, nearer)) return false;
    primitive_ = hn::BitCast(Bits(), hn::IfThenElse(nearer, id, hn::BitCast(tag, primitive_)));
    hn::BlendedStore(u, nearer, tag, u_);
    hn::BlendedStore(v, nearer, tag, v_);
    // For any hit the first is enough: with a t below its t_min, the ray is inactive from now on.
    t_best_ = hn::IfThenElse(nearer, any_hit ? hn::Set(tag, -1.0f) : t, t_best_);
    return true;
  }

  HWY_NOINLINE HWY_ATTR bool test_exactly(const Corner* corners, M which, std::uint32_t primitive) {
    const Tag tag;
    alignas(64) float lane[3][3][width], dz[width], t_min[width], t_max[width], t[width], u[width], v[width];
    for (std::size_t k = 0; k < 3; ++k) {
      hn::Store(corners[k].x, tag, lane[k][0]);
      hn::Store(corners[k].y, tag, lane[k][1]);
      hn::Store(corners[k].z, tag, lane[k][2]);
    }
    hn::Store(dz_, tag, dz);
    hn::Store(t_min_, tag, t_min);
    hn::Store(t_best_, tag, t_max);
    for (std::size_t i = 0; i < width; ++i) {
      const auto corner = [&](std::size_t k) {
        return ShearedCorner(lane[k][0][i], lane[k][1][i], lane[k][2][i]);
      };
      Hit hit{.t = -1.0f};  // a miss becomes a t that no ray reaches
      kerf::intersect_exactly(corner(0), corner(1), corner(2), dz[i], t_min[i], t_max[i], hit);
      t[i] = hit.t;
      u[i] = hit.u;
      v[i] = hit.v;
    }
    return keep_nearer(hn::Load(tag, t), hn::Load(tag, u), hn::Load(tag, v), primitive, which);
  }

  const WideBvh& bvh_;
  V inverse_[3], enter_[3], leave_[3], t_min_, t_best_;
  V shear_origin_[3], sx_, sy_;
  V dz_, inverse_dz_;
  hn::Vec<Bits> primitive_;
  alignas(64) float u_[width], v_[width];
  float inverse_low_[3], inverse_high_[3], origin_low_[3], origin_high_[3];  // of the packet
  float t_first_, t_last_;
  std::size_t near_[3], far_[3], axis_[3];
  std::uint32_t octant_;
  std::uint64_t visits_, active_;
  Entry stack_[Stack<1>::capacity];
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();
#endif

#endif
