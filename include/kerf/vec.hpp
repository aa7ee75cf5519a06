// Points, directions and axis-aligned boxes: plain values, the vocabulary of every other header.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <limits>

namespace kerf {

/// A point or a direction in three dimensions.
struct Vec3f {
  float x = 0.0f;  ///< along the first axis
  float y = 0.0f;  ///< along the second
  float z = 0.0f;  ///< along the third

  /// The component on `axis`: 0 is x, 1 is y, 2 is z.
  constexpr float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  /// The same, to write to.
  constexpr float& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }

  friend constexpr bool operator==(const Vec3f&, const Vec3f&) = default;
};

/// The same in double precision, for places far from the origin: see `DoubleMesh`.
struct Vec3d {
  double x = 0.0;  ///< along the first axis
  double y = 0.0;  ///< along the second
  double z = 0.0;  ///< along the third

  friend constexpr bool operator==(const Vec3d&, const Vec3d&) = default;
};

/// An axis-aligned box, both ends included. A default box is empty: growing it by a point gives that point.
struct Box3f {
  /// The smallest coordinates in the box.
  Vec3f lower{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
              std::numeric_limits<float>::infinity()};
  /// The largest coordinates in the box.
  Vec3f upper{-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
              -std::numeric_limits<float>::infinity()};

  /// True where no point lies inside.
  constexpr bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }

  friend constexpr bool operator==(const Box3f&, const Box3f&) = default;
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
