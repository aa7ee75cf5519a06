// Whether a line crosses a triangle, decided exactly: no tolerance, and every edge belongs to one of its two
// sides. The library's `line_crosses` once more.
#pragma once

#include "predicates.hpp"

namespace kerf::cuda {

KERF_CUDA_BOTH inline int moved_side(const Vec3f& d, const Vec3f& a, const Vec3f& b, int i) {
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  ExactSum cross;
  cross.add_product(component(d, j), component(b, k));
  cross.add_product(-component(d, j), component(a, k));
  cross.add_product(-component(d, k), component(b, j));
  cross.add_product(component(d, k), component(a, j));
  return cross.sign();
}
/// The side on which the line passes the edge; a line through the edge itself is moved aside by an
/// infinitesimal amount, the same for all triangles (Edelsbrunner & Mücke 1990, "Simulation of Simplicity").
KERF_CUDA_NOINLINE int exact_edge_side(Vec3f o, Vec3f d, Vec3f a, Vec3f b) {
  int sign;
  {
    ExactSum sum;
    add_edge_side(sum, o, d, a, b);
    sign = sum.sign();
  }
  for (int i = 0; i < 3 && sign == 0; ++i) sign = moved_side(d, a, b, i);
  return sign;
}
KERF_CUDA_INLINE int certain_sign(const Determinant& w) {
  return w.certain() ? (w.value > 0.0 ? 1 : -1) : 0;
}

/// Whether the whole line crosses the triangle, whichever way that faces.
KERF_CUDA_BOTH inline bool line_crosses(const Vec3f& o, const Vec3f& d, const Corners& triangle) {
  const Vec3f &a = triangle.a, &b = triangle.b, &c = triangle.c;
  const Vec3d direction = widen(d), ao = difference(a, o), bo = difference(b, o), co = difference(c, o);
  int sa = certain_sign(determinant(direction, bo, co)), sb = certain_sign(determinant(direction, co, ao)),
      sc = certain_sign(determinant(direction, ao, bo));
  if (sa * sb < 0 || sb * sc < 0 || sc * sa < 0) return false;
  if (sa == 0) sa = exact_edge_side(o, d, b, c);
  if (sb == 0) sb = exact_edge_side(o, d, c, a);
  if (sc == 0) sc = exact_edge_side(o, d, a, b);
  return sa != 0 && sa == sb && sb == sc;
}

}  // namespace kerf::cuda
