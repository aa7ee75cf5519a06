// A triangle by its vertices.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <kerf/vec.hpp>

namespace kerf {

/// A triangle by its vertices, in the order of its mesh.
struct Triangle {
  Vec3f v0;  ///< the first vertex
  Vec3f v1;  ///< the second
  Vec3f v2;  ///< the third

  friend constexpr bool operator==(const Triangle&, const Triangle&) = default;
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
