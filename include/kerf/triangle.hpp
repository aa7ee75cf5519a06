// A triangle by its vertices.
#pragma once

#include <kerf/vec.hpp>

namespace kerf {

struct Triangle {
  Vec3f v0, v1, v2;

  friend constexpr bool operator==(const Triangle&, const Triangle&) = default;
};

}  // namespace kerf
