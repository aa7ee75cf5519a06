#include <algorithm>
#include <limits>

#include "layout/wide_bvh.hpp"
#include "math/predicates.hpp"
#include "simd/targets.hpp"
#include "traversal/dispatch.hpp"
#include "traversal/lines/prepared_line.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/lines/line_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/doubles-inl.h"
#include "traversal/node-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// The signs of determinants, as far as they are certain: see `Determinant`.
struct Signs {
  hn::Mask<DoubleTag> positive, negative;
};

// `determinant` of math/predicates.hpp, operation by operation.
HWY_INLINE Signs determinant_signs(const Vec3Doubles& a, const Vec3Doubles& b, const Vec3Doubles& c) {
  const auto yz = hn::Mul(b.y, c.z), zy = hn::Mul(b.z, c.y), zx = hn::Mul(b.z, c.x), xz = hn::Mul(b.x, c.z),
             xy = hn::Mul(b.x, c.y), yx = hn::Mul(b.y, c.x);
  const auto sizes = [](DoubleVector p, DoubleVector q) HWY_ATTR { return hn::Add(hn::Abs(p), hn::Abs(q)); };
  const auto value = hn::Add(hn::Add(hn::Mul(a.x, hn::Sub(yz, zy)), hn::Mul(a.y, hn::Sub(zx, xz))),
                             hn::Mul(a.z, hn::Sub(xy, yx)));
  const auto size =
      hn::Add(hn::Add(hn::Mul(hn::Abs(a.x), sizes(yz, zy)), hn::Mul(hn::Abs(a.y), sizes(zx, xz))),
              hn::Mul(hn::Abs(a.z), sizes(xy, yx)));
  const auto error = hn::Mul(hn::Set(DoubleTag(), Determinant::bound), size);
  return {hn::Gt(value, error), hn::Lt(value, hn::Neg(error))};
}

}  // namespace

std::uint32_t line_meets(const WideBvh& bvh, std::uint32_t number, const PreparedLine& line, float* entry,
                         ChildLink* children) {
  const Node& node = node_at(bvh, number);
  std::copy_n(node.children, node_width, children);
  const DoubleTag tag;
  const hn::Rebind<float, DoubleTag> narrow;
  // A difference, a reciprocal and a product give each distance a relative error of up to 3 * 2^-53.
  const auto late = hn::Set(tag, 1.0 + 8.0 / 9007199254740992.0), early = hn::Set(tag, 1.0 - 0x1p-23);
  const double inverses[3] = {line.inverse.x, line.inverse.y, line.inverse.z};
  std::uint32_t met = 0;
  for (std::size_t i = 0; i < node_width; i += double_lanes) {
    auto enter = hn::Set(tag, double{line.t_min}), leave = hn::Set(tag, double{line.t_max});
    for (int axis = 0; axis < 3; ++axis) {
      const auto origin = hn::Set(tag, double{line.origin[axis]}), inverse = hn::Set(tag, inverses[axis]);
      const bool backwards = inverses[axis] < 0.0;
      const auto distance = [&](bool upper, auto rounding) HWY_ATTR {
        const auto plane = load_doubles(node.planes[axis][upper] + i);
        return hn::Mul(hn::Mul(hn::Sub(plane, origin), inverse), rounding);
      };
      const auto near = distance(backwards, early), far = distance(!backwards, late);
      enter = hn::IfThenElse(hn::Gt(near, enter), near, enter);
      leave = hn::IfThenElse(hn::Lt(far, leave), far, leave);
    }
    met |= bits(tag, hn::Le(enter, leave)) << i;
    const auto max_float = hn::Set(tag, double{std::numeric_limits<float>::max()});
    hn::StoreU(hn::DemoteTo(narrow, hn::Min(enter, max_float)), narrow, entry + i);
  }
  return met;
}

std::uint32_t line_may_cross(const WideBvh& bvh, ChildLink leaf, const PreparedLine& line) {
  const std::uint32_t count = leaf.count();
  const float* rows = leaf_rows(bvh, leaf);
  const Vec3Doubles origin = broadcast_doubles(line.origin), direction = broadcast_doubles(line.direction);
  std::uint32_t may = 0;
  for (std::uint32_t begin = 0; begin < count; begin += double_lanes) {
    const auto corner = [&](std::size_t row)
                            HWY_ATTR { return load_vectors(rows + row * count + begin, count) - origin; };
    const Vec3Doubles a = corner(0), b = corner(3), c = corner(6);
    const Signs wa = determinant_signs(direction, b, c), wb = determinant_signs(direction, c, a),
                wc = determinant_signs(direction, a, b);
    const auto positive = hn::Or(hn::Or(wa.positive, wb.positive), wc.positive);
    const auto negative = hn::Or(hn::Or(wa.negative, wb.negative), wc.negative);
    may |= (~bits(DoubleTag(), hn::And(positive, negative)) & ((1u << double_lanes) - 1)) << begin;
  }
  return may & ((1u << count) - 1);
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();
