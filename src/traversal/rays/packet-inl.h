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
HWY_INLINE std::uint32_t far_to_near(const Node& node, const Spans& spans, std::uint32_t octant,
                                     std::uint32_t (&out)[node_width]) {
  const NodeFloats::Tag floats;
  const hn::RebindToUnsigned<NodeFloats::Tag> integers;
  const auto slots = far_to_near_slots(node, octant);
  const auto float_slots = hn::IndicesFromVec(floats, slots);
  const auto mask = hn::Le(hn::TableLookupLanes(spans.first.vector[0], float_slots),
                           hn::TableLookupLanes(spans.last.vector[0], float_slots));
  hn::StoreU(compress(slots, mask), integers, out);
  return static_cast<std::uint32_t>(hn::CountTrue(floats, mask));
}

// As many rays as a vector has lanes. Their directions lie in one octant, are largest along the same axis and
// differ little. The boxes of a node are tested against the packet as a whole, in interval arithmetic
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
    if (is_far(hn::GetLane(hn::MaxOfLanes(tag, distance)), bvh_)) return false;
    const V margin = boxes_margin(tag, distance, bvh_);
    float min_margin, max_margin;
    find_range(hn::Add(margin, margin), min_margin,
               max_margin);  // twice: for the rounding of the interval arithmetic as well
    const V min_component = hn::Mul(largest, hn::Set(tag, RayBoxes::least_part));
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
      near_[a] = (2 * a + negative) * node_width;
      far_[a] = (2 * a + 1 - negative) * node_width;
    }
    const ShearAxes& axes = shear_axes[2 * kz + ((octant_ >> kz) & 1)];
    for (std::size_t a = 0; a < 3; ++a) {
      axis_[a] = axes.axis[a];
      shear_origin_[a] = origin[axes.axis[a]];
      origin_[a] = origin[a];
      direction_[a] = direction[a];
    }
    sx_ = hn::Div(direction[axis_[0]], direction[kz]);
    sy_ = hn::Div(direction[axis_[1]], direction[kz]);
    inverse_dz_ = hn::Div(hn::Set(tag, 1.0f), direction[kz]);
    const V error = hn::Mul(hn::Mul(hn::Set(tag, 0x1p-24f), distance), hn::Abs(inverse_dz_));
    error_of_mean_ = hn::Mul(hn::Set(tag, LeafConstants::mean_error), error);
    error_of_shear_ = hn::Mul(hn::Set(tag, LeafConstants::shear_error), error);
    rays_ = rays;
    t_min_ = t_min;
    first_ = last_ = hn::Min(t_max, hn::Set(tag, std::numeric_limits<float>::max()));
    primitive_ = hn::Set(Bits(), invalid_id);
    link_ = lane_ = hn::Zero(Bits());
    float unused;
    find_range(t_min_, t_first_, unused);
    find_range(last_, unused, t_last_);
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
      const M active = hn::And(hn::Le(hn::Load(tag, entry.t), last_), hn::LoadMaskBits(tag, entry.rays));
      if (hn::AllFalse(tag, active)) continue;
      ++visits_;
      active_ += hn::CountTrue(tag, active);
      if (link.is_leaf()) {
        test(link, active);
      } else {
        open(link.node(), active, depth);
      }
    }
    alignas(64) std::uint32_t primitive[width];
    hn::Store(primitive_, Bits(), primitive);
    if constexpr (any_hit) {
      for (std::size_t i = 0; i < width; ++i) finish(i, Hit{.primitive = primitive[i]});
      return;
    }
    alignas(64) float t[width], u[width], v[width];
    settle(t, u, v);
    for (std::size_t i = 0; i < width; ++i)
      finish(i, Hit{.t = t[i], .u = u[i], .v = v[i], .primitive = primitive[i]});
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

  // Less than every t.
  static constexpr float no_t = -std::numeric_limits<float>::infinity();

  // Of rays that hit the same triangle: fewer are settled one by one.
  static constexpr int min_rays_at_once = 4;

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
    const Node& node = node_at(bvh_, index);
    const float* planes = &node.planes[0][0][0];
    NodeFloats first = broadcast<node_width>(t_first_), last = broadcast<node_width>(t_last_);
    for (std::size_t a = 0; a < 3; ++a) {
      const bool negative = (octant_ >> a) & 1;
      const NodeFloats low = broadcast<node_width>(inverse_low_[a]),
                       high = broadcast<node_width>(inverse_high_[a]);
      const NodeFloats near = load<node_width>(planes + near_[a]) -
                              broadcast<node_width>(negative ? origin_low_[a] : origin_high_[a]);
      const NodeFloats far = load<node_width>(planes + far_[a]) -
                             broadcast<node_width>(negative ? origin_high_[a] : origin_low_[a]);
      first = maximum(first, minimum(near * low, near * high));
      last = minimum(last, maximum(far * low, far * high));
    }
    std::uint32_t slots_met[node_width];
    const std::uint32_t met = far_to_near(node, {first, last}, octant_, slots_met);
    for (std::uint32_t i = 0; i < met; ++i) {
      const std::uint32_t slot = slots_met[i];
      const auto plane = [&](std::size_t from) HWY_ATTR { return hn::Set(tag, planes[from + slot]); };
      const V t = hn::Max(hn::Max(hn::MulAdd(plane(near_[0]), inverse_[0], enter_[0]),
                                  hn::MulAdd(plane(near_[1]), inverse_[1], enter_[1])),
                          hn::Max(hn::MulAdd(plane(near_[2]), inverse_[2], enter_[2]), t_min_));
      const V end = hn::Min(hn::Min(hn::MulAdd(plane(far_[0]), inverse_[0], leave_[0]),
                                    hn::MulAdd(plane(far_[1]), inverse_[1], leave_[1])),
                            hn::Min(hn::MulAdd(plane(far_[2]), inverse_[2], leave_[2]), last_));
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

  // t, u and v of all hits: for all rays that hit the same triangle at once.
  HWY_INLINE void settle(float* t, float* u, float* v) const {
    const Tag tag;
    hn::Store(hn::Set(tag, std::numeric_limits<float>::infinity()), tag, t);
    hn::Store(hn::Zero(tag), tag, u);
    hn::Store(hn::Zero(tag), tag, v);
    alignas(64) std::uint32_t link[width], lane[width];
    hn::Store(link_, Bits(), link);
    hn::Store(lane_, Bits(), lane);
    std::uint32_t rest = bits(Bits(), hn::Ne(primitive_, hn::Set(Bits(), invalid_id)));
    while (rest != 0) {
      const auto first = static_cast<std::size_t>(std::countr_zero(rest));
      const ChildLink leaf(link[first]);
      std::uint32_t same = rest & bits(Bits(), hn::And(hn::Eq(link_, hn::Set(Bits(), link[first])),
                                                       hn::Eq(lane_, hn::Set(Bits(), lane[first]))));
      rest &= ~same;
      if (std::popcount(same) >= min_rays_at_once)
        same &= ~settle_at_once(triangle_in(bvh_, leaf, lane[first]), same, t, u, v);
      for (; same != 0; same &= same - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(same));
        const RayCrossing crossing = hit_in_leaf(bvh_, leaf, lane[first], rays_[i]);
        t[i] = crossing.t;
        u[i] = crossing.u;
        v[i] = crossing.v;
      }
    }
  }

  // `estimate_crossing` operation by operation, for half of the rays at a time. Returns the rays for which it
  // is enough, a bit for each; for those in `which` t, u and v are written.
  HWY_INLINE std::uint32_t settle_at_once(const Triangle& triangle, std::uint32_t which, float* t, float* u,
                                          float* v) const {
    using Doubles = hn::ScalableTag<double>;
    using Half = hn::Rebind<float, Doubles>;
    using D = hn::Vec<Doubles>;
    const Doubles doubles;
    const Half half;
    const Vec3d e = difference(triangle.v1, triangle.v0), f = difference(triangle.v2, triangle.v0);
    const Vec3d n = cross(e, f);
    const double edges = largest_component(e) * largest_component(f), normal = largest_component(n);
    if (!(normal >= (1.0 / CrossingEstimate::min_slope) * CrossingEstimate::min_precise * edges)) return 0;
    std::uint32_t enough = 0;
    for (std::size_t i = 0; i < width; i += hn::MaxLanes(doubles)) {
      const auto widened = [&](const V& floats) HWY_ATTR {
        return hn::PromoteTo(doubles, i == 0 ? hn::LowerHalf(half, floats) : hn::UpperHalf(half, floats));
      };
      const auto sum = [](D x, D y, D z) HWY_ATTR { return hn::Add(hn::Add(x, y), z); };
      const auto times = [&](D x, double y) HWY_ATTR { return hn::Mul(x, hn::Set(doubles, y)); };
      const auto largest = [](D x, D y, D z)
                               HWY_ATTR { return hn::Max(hn::Max(hn::Abs(x), hn::Abs(y)), hn::Abs(z)); };
      const D px = hn::Sub(hn::Set(doubles, double{triangle.v0.x}), widened(origin_[0])),
              py = hn::Sub(hn::Set(doubles, double{triangle.v0.y}), widened(origin_[1])),
              pz = hn::Sub(hn::Set(doubles, double{triangle.v0.z}), widened(origin_[2]));
      const D dx = widened(direction_[0]), dy = widened(direction_[1]), dz = widened(direction_[2]);
      const D height = sum(times(px, n.x), times(py, n.y), times(pz, n.z));
      const D slope = sum(times(dx, n.x), times(dy, n.y), times(dz, n.z));
      const D rx = hn::Sub(hn::Mul(dy, pz), hn::Mul(dz, py)), ry = hn::Sub(hn::Mul(dz, px), hn::Mul(dx, pz)),
              rz = hn::Sub(hn::Mul(dx, py), hn::Mul(dy, px));
      const D at_t = hn::Div(height, slope);
      const D at_u = hn::Div(hn::Neg(sum(times(rx, f.x), times(ry, f.y), times(rz, f.z))), slope);
      const D at_v = hn::Div(sum(times(rx, e.x), times(ry, e.y), times(rz, e.z)), slope);
      const auto steep =
          hn::Ge(hn::Abs(slope), times(times(largest(dx, dy, dz), CrossingEstimate::min_slope), normal));
      const auto precise =
          hn::Ge(hn::Abs(height), times(times(largest(px, py, pz), CrossingEstimate::min_precise), edges));
      const D size = hn::Abs(at_t), zero = hn::Zero(doubles);
      const auto in_range =
          hn::And(hn::Ge(size, hn::Set(doubles, 0x1p-126)), hn::Lt(size, hn::Set(doubles, 0x1p127)));
      const auto inside = hn::And(hn::And(hn::Ge(at_u, zero), hn::Ge(at_v, zero)),
                                  hn::Le(hn::Add(at_u, at_v), hn::Set(doubles, 1.0)));
      const auto fit = hn::And(hn::And(steep, precise), hn::And(in_range, inside));
      enough |= bits(doubles, fit) << i;
      alignas(64) float lanes[3][hn::MaxLanes(doubles)];
      hn::Store(hn::DemoteTo(half, at_t), half, lanes[0]);
      hn::Store(hn::DemoteTo(half, at_u), half, lanes[1]);
      hn::Store(hn::DemoteTo(half, at_v), half, lanes[2]);
      for (std::uint32_t rest = (enough & which) >> i & ((1u << hn::MaxLanes(doubles)) - 1); rest != 0;
           rest &= rest - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(rest));
        t[i + k] = lanes[0][k];
        u[i + k] = lanes[1][k];
        v[i + k] = lanes[2][k];
      }
    }
    return enough;
  }

  // `intersect_leaf` for each triangle of a leaf and the active rays.
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

      const V determinant = hn::Add(hn::Add(u, v), w);
      const V inverse = hn::Div(hn::Set(tag, 1.0f), determinant);
      const V z = hn::Add(hn::Add(hn::Mul(u, a.z), hn::Mul(v, b.z)), hn::Mul(w, c.z));
      const V t = hn::Mul(hn::Mul(z, inverse), inverse_dz_);
      const auto apart = [](V p, V q) HWY_ATTR { return hn::Abs(hn::Sub(p, q)); };
      const V rise = hn::Add(hn::Mul(hn::Add(apart(b.x, a.x), apart(b.y, a.y)), apart(c.z, a.z)),
                             hn::Mul(hn::Add(apart(c.x, a.x), apart(c.y, a.y)), apart(b.z, a.z)));
      const V error = hn::Add(error_of_mean_, hn::Mul(hn::Mul(error_of_shear_, rise), hn::Abs(inverse)));
      const V first = hn::Sub(t, error), last = hn::Add(t, error);
      const M large_enough = hn::Or(hn::Lt(hn::Set(tag, SinglePrecision::min_value), min_edge),
                                    hn::Lt(max_edge, hn::Set(tag, -SinglePrecision::min_value)));
      const V limit = hn::Set(tag, SinglePrecision::max_value);
      const M small_enough = hn::And(hn::Lt(hn::Abs(determinant), limit), hn::Lt(hn::Abs(t), limit));
      const M trusted = hn::And(candidates, hn::And(large_enough, small_enough));
      // As in `intersect_group`.
      const M bounded = hn::And(
          hn::Lt(hn::Set(tag, SinglePrecision::min_value), hn::Max(hn::Abs(min_edge), hn::Abs(max_edge))),
          small_enough);

      const M in_range = hn::And(hn::Le(t_min_, last), hn::Le(first, last_));
      const M near = hn::And(in_range, trusted);
      const M clear = hn::And(hn::And(hn::Le(t_min_, first), hn::Lt(last, first_)), near);
      if (!hn::AllFalse(tag, clear)) {
        // For any hit, the first is enough: with `no_t`, the ray takes no further part.
        first_ = hn::IfThenElse(clear, any_hit ? hn::Set(tag, no_t) : first, first_);
        last_ = hn::IfThenElse(clear, any_hit ? hn::Set(tag, no_t) : last, last_);
        const auto keep = [&](hn::Vec<Bits>& kept, std::uint32_t value) HWY_ATTR {
          const V number = hn::BitCast(tag, hn::Set(Bits(), value));
          kept = hn::BitCast(Bits(), hn::IfThenElse(clear, number, hn::BitCast(tag, kept)));
        };
        keep(primitive_, words[9 * count + i]);
        keep(link_, leaf.bits());
        keep(lane_, i);
        changed = true;
      }
      const M unbounded = hn::AndNot(bounded, candidates);
      const M open = hn::AndNot(clear, hn::Or(hn::And(in_range, candidates), unbounded));
      if (HWY_UNLIKELY(!hn::AllFalse(tag, open)))
        changed |= test_one_by_one(leaf, i, bits(tag, open), bits(tag, trusted));
    }
    if (changed) t_last_ = hn::GetLane(hn::MaxOfLanes(tag, last_));
  }

  // Triangle `i` of a leaf, for the `rays` that single precision leaves open: whether it lies before the
  // nearest where that is `trusted`, else also whether they pass it within its edges.
  HWY_NOINLINE HWY_ATTR bool test_one_by_one(ChildLink leaf, std::uint32_t i, std::uint32_t rays,
                                             std::uint32_t trusted) {
    const Tag tag;
    alignas(64) float t_min[width], first[width], last[width];
    alignas(64) std::uint32_t primitive[width], link[width], lane[width];
    hn::Store(t_min_, tag, t_min);
    hn::Store(first_, tag, first);
    hn::Store(last_, tag, last);
    hn::Store(primitive_, Bits(), primitive);
    hn::Store(link_, Bits(), link);
    hn::Store(lane_, Bits(), lane);
    bool changed = false;
    for (; rays != 0; rays &= rays - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(rays));
      Nearest best;
      best.first = first[k];
      best.last = last[k];
      best.primitive = primitive[k];
      best.link = link[k];
      best.lane = lane[k];
      best = (trusted >> k & 1)
                 ? nearer_of(bvh_, leaf, i, rays_[k], t_min[k], NoFilter(), best)
                 : intersect_one_by_one(bvh_, leaf, 1u << i, rays_[k], t_min[k], NoFilter(), best);
      const bool hit = best.primitive != primitive[k];
      changed |= hit;
      first[k] = any_hit && hit ? no_t : best.first;
      last[k] = any_hit && hit ? no_t : best.last;
      primitive[k] = best.primitive;
      link[k] = best.link;
      lane[k] = best.lane;
    }
    first_ = hn::Load(tag, first);
    last_ = hn::Load(tag, last);
    primitive_ = hn::Load(Bits(), primitive);
    link_ = hn::Load(Bits(), link);
    lane_ = hn::Load(Bits(), lane);
    return changed;
  }

  const WideBvh& bvh_;
  const Ray* rays_ = nullptr;
  V origin_[3], direction_[3];
  V inverse_[3], enter_[3], leave_[3], t_min_;
  V first_, last_;  // as in `Nearest`
  hn::Vec<Bits> primitive_, link_, lane_;
  V shear_origin_[3], sx_, sy_, inverse_dz_;
  V error_of_mean_, error_of_shear_;
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
