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

}  // namespace kerf
