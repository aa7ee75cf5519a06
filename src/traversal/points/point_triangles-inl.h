// A point and all triangles of a leaf.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_POINTS_POINT_TRIANGLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_POINTS_POINT_TRIANGLES_INL_H
#undef KERF_TRAVERSAL_POINTS_POINT_TRIANGLES_INL_H
#else
#define KERF_TRAVERSAL_POINTS_POINT_TRIANGLES_INL_H
#endif

#include <algorithm>
#include <bit>

#include <hwy/highway.h>

#include "simd/doubles-inl.h"
#include "traversal/points/near_triangle.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

HWY_INLINE DoubleVector size(const Vec3Doubles& a) {
  return dn::Add(dn::Add(dn::Abs(a.x), dn::Abs(a.y)), dn::Abs(a.z));
}

struct ClosestPoints {
  DoubleVector squared_distance, u, v;
};

// The squared distance of the edge between two corners, which are given relative to the point. The closest
// point lies `s` of the way from `from` to `to`. It is computed from the nearer end, so that it is exact at
// both ends.
HWY_INLINE DoubleVector closest_on_edge(const Vec3Doubles& from, const Vec3Doubles& to,
                                        const Vec3Doubles& edge, DoubleVector& s) {
  const DoubleTag tag;
  const auto one = dn::Set(tag, 1.0), zero = dn::Zero(tag);
  const auto length = dot(edge, edge);
  const auto foot = dn::Div(dn::Neg(dot(from, edge)), length);
  s = dn::IfThenElseZero(dn::Lt(zero, length), dn::Min(dn::Max(foot, zero), one));
  const auto near_from = dn::Le(s, dn::Set(tag, 0.5));
  const auto from_end = dn::IfThenElse(near_from, s, dn::Sub(s, one));
  const auto on_edge = [&](DoubleVector a, DoubleVector b, DoubleVector e) HWY_ATTR {
    return dn::Add(dn::IfThenElse(near_from, a, b), dn::Mul(from_end, e));
  };
  const Vec3Doubles q{on_edge(from.x, to.x, edge.x), on_edge(from.y, to.y, edge.y),
                      on_edge(from.z, to.z, edge.z)};
  return dot(q, q);
}

// The triangles of a leaf against one point.
class PointTriangles {
 public:
  HWY_INLINE explicit PointTriangles(const Vec3f& p) : point_(broadcast_doubles(p)) {}

  // Calls `found` for each triangle of the leaf within the square root of `reach`.
  template <class Found>
  HWY_INLINE void find(const WideBvh& bvh, ChildLink leaf, double reach, Found&& found) const {
    const DoubleTag tag;
    const std::uint32_t count = leaf.count();
    const float* rows = leaf_rows(bvh, leaf);
    for (std::uint32_t begin = 0; begin < count; begin += double_lanes) {
      const Corners corners = load_corners(rows + begin, count);
      const auto reaches = dn::Set(tag, reach);
      const std::uint32_t there = (1u << std::min<std::uint32_t>(count - begin, double_lanes)) - 1;
      if ((there & ~bits(tag, plane_is_beyond(corners, reaches))) == 0) continue;
      const ClosestPoints closest = closest_points(corners);
      std::uint32_t near = there & bits(tag, dn::Le(closest.squared_distance, reaches));
      if (near == 0) continue;
      alignas(64) double squares[double_lanes], us[double_lanes], vs[double_lanes];
      dn::Store(closest.squared_distance, tag, squares);
      dn::Store(closest.u, tag, us);
      dn::Store(closest.v, tag, vs);
      for (; near != 0; near &= near - 1) {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(near));
        found(NearTriangle{squares[i], us[i], vs[i], triangle_id(bvh, leaf, begin + i), leaf, begin + i});
      }
    }
  }

 private:
  // Corners are relative to the point, edges are differences of corners.
  struct Corners {
    Vec3Doubles a, b, c, ab, bc, ca;
  };

  HWY_INLINE Corners load_corners(const float* rows, std::size_t count) const {
    const Vec3Doubles a = load_vectors(rows, count), b = load_vectors(rows + 3 * count, count),
                      c = load_vectors(rows + 6 * count, count);
    return {a - point_, b - point_, c - point_, b - a, c - b, a - c};
  }

  // Whether the plane of a triangle, and thus the triangle, is farther away than the square root of `reach`.
  // False where rounding leaves that open.
  HWY_INLINE static DoubleMask plane_is_beyond(const Corners& corners, DoubleVector reach) {
    const DoubleTag tag;
    const Vec3Doubles normal = cross(corners.ca, corners.ab);
    // Some ten roundings of 2^-53 on products of these sizes. They may be larger than the normal of a sliver.
    constexpr double rounding = 32.0 / 9007199254740992.0;
    const auto error = dn::Mul(dn::Set(tag, rounding), dn::Mul(size(corners.ab), size(corners.ca)));
    const auto height = dn::Sub(dn::Abs(dot(normal, corners.a)), dn::Mul(error, size(corners.a)));
    // (n + e)^2 <= (1 + d) n^2 + (1 + 1 / d) e^2
    constexpr double d = 1e-6;
    const auto square = dn::Add(dn::Mul(dn::Set(tag, (1.0 + d) * (1.0 + d)), dot(normal, normal)),
                                dn::Mul(dn::Set(tag, (1.0 + 1.0 / d) * (1.0 + d)), dn::Mul(error, error)));
    return dn::And(dn::Lt(dn::Zero(tag), height), dn::Lt(dn::Mul(reach, square), dn::Mul(height, height)));
  }

  // The closest point of the three edges, or the foot of the perpendicular where that falls inside. Slivers
  // keep their accuracy, since the closest point of an edge needs no division by the triangle's area.
  HWY_INLINE static ClosestPoints closest_points(const Corners& corners) {
    const DoubleTag tag;
    const auto zero = dn::Zero(tag);
    const auto& [a, b, c, ab, bc, ca] = corners;
    DoubleVector s;
    ClosestPoints best{closest_on_edge(a, b, ab, s), zero, zero};
    best.u = s;
    const auto take = [&](DoubleMask nearer, const ClosestPoints& other) HWY_ATTR {
      best.squared_distance = dn::IfThenElse(nearer, other.squared_distance, best.squared_distance);
      best.u = dn::IfThenElse(nearer, other.u, best.u);
      best.v = dn::IfThenElse(nearer, other.v, best.v);
    };
    const auto on_bc = closest_on_edge(b, c, bc, s);
    take(dn::Lt(on_bc, best.squared_distance), {on_bc, dn::Sub(dn::Set(tag, 1.0), s), s});
    const auto on_ca = closest_on_edge(c, a, ca, s);
    take(dn::Lt(on_ca, best.squared_distance), {on_ca, zero, dn::Sub(dn::Set(tag, 1.0), s)});

    const Vec3Doubles normal = cross(ca, ab);
    const auto wa = dot(normal, cross(b, c)), wb = dot(normal, cross(c, a)), wc = dot(normal, cross(a, b));
    const auto inside = dn::Lt(zero, dn::Min(dn::Min(wa, wb), wc));
    const auto height = dot(normal, a);
    const auto on_face = dn::Div(dn::Mul(height, height), dot(normal, normal));
    const auto sum = dn::Add(dn::Add(wa, wb), wc);
    take(dn::And(inside, dn::Lt(on_face, best.squared_distance)),
         {on_face, dn::Div(wb, sum), dn::Div(wc, sum)});
    return best;
  }

  Vec3Doubles point_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
