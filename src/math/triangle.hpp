// A triangle by its corners.
#pragma once

#include "math/box3f.hpp"

namespace kerf {

struct Triangle {
  Vec3f v0, v1, v2;
};

inline Box3f bounds_of(const Triangle& t) {
  return {min(min(t.v0, t.v1), t.v2), max(max(t.v0, t.v1), t.v2)};
}

/// True for a triangle without area. Twice the area is the length of the cross product of two edges. In
/// double precision the edges of floats are exact (or nearly: where exponents are 2^29 apart), and neither
/// 1e-9 squared nor 1e38 squared leaves the range; so only a triangle whose corners are in one line, as
/// exactly as that can be said, is degenerate.
inline bool is_degenerate(const Triangle& t) {
  const double ux = double{t.v1.x} - t.v0.x, uy = double{t.v1.y} - t.v0.y, uz = double{t.v1.z} - t.v0.z;
  const double vx = double{t.v2.x} - t.v0.x, vy = double{t.v2.y} - t.v0.y, vz = double{t.v2.z} - t.v0.z;
  return uy * vz == uz * vy && uz * vx == ux * vz && ux * vy == uy * vx;
}

}  // namespace kerf
