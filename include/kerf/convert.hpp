// Points, directions and rays from the types of other libraries, without including any of them.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <concepts>
#include <limits>
#include <type_traits>
#include <utility>

#include <kerf/ray.hpp>
#include <kerf/triples.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// @cond  not for callers
namespace triples {

template <class T, class Scalar>
concept Gives = std::same_as<std::remove_cvref_t<T>, Scalar>;

/// Members x, y and z, and no w.
template <class V, class Scalar>
concept HasAxes = requires(const V& v) {
  { v.x } -> Gives<Scalar>;
  { v.y } -> Gives<Scalar>;
  { v.z } -> Gives<Scalar>;
}
&&!requires(const V& v) {
  v.w;
};

/// Three elements, as the type itself says.
template <class V, class Scalar>
concept HasElements = (fixed_size<V>() == 3) && requires(const V& v) {
  { v[0] } -> Gives<Scalar>;
};

/// Functions x, y and z.
template <class V, class Scalar>
concept HasFunctions = requires(const V& v) {
  { v.x() } -> Gives<Scalar>;
  { v.y() } -> Gives<Scalar>;
  { v.z() } -> Gives<Scalar>;
}
&&!requires(const V& v) {
  v.w();
};

template <class To, class V>
constexpr To converted(const V& v) {
  if constexpr (requires { v.x + v.y + v.z; }) {
    return {v.x, v.y, v.z};
  } else if constexpr (fixed_size<V>() == 3) {
    return {v[0], v[1], v[2]};
  } else {
    return {v.x(), v.y(), v.z()};
  }
}

}  // namespace triples
/// @endcond

/// A value of type `V` is three scalars of type `Scalar`: members or functions x, y and z, or an array,
/// vector or expression of exactly three elements.
template <class V, class Scalar>
concept VectorOf =
    triples::HasAxes<V, Scalar> || triples::HasElements<V, Scalar> || triples::HasFunctions<V, Scalar>;

/// A point or a direction from any vector of three floats: `glm::vec3`, `Eigen::Vector3f`,
/// `std::array<float, 3>`, `float[3]`, a struct with members x, y and z. `Vec3f` itself has no constructors,
/// so that its fields can be named where one is made.
template <class V>
requires VectorOf<V, float>
constexpr Vec3f to_vec3f(const V& vector) {
  return triples::converted<Vec3f>(vector);
}

/// @cond
// clang-format off
template <class V> requires(!VectorOf<V, float>)
Vec3f to_vec3f(const V&) = delete;  // not three floats: round doubles with static_cast, or build a kerf::DoubleMesh
// clang-format on
/// @endcond

/// A place in double precision from any vector of three doubles, or of three floats, which lose nothing.
template <class V>
requires(VectorOf<V, double> || VectorOf<V, float>) constexpr Vec3d to_vec3d(const V& vector) {
  return triples::converted<Vec3d>(vector);
}

/// A ray from any two vectors of three floats.
template <class Origin, class Direction>
requires(VectorOf<Origin, float>&& VectorOf<Direction, float>) constexpr Ray
    to_ray(const Origin& origin, const Direction& direction, float t_min = 0.0f,
           float t_max = std::numeric_limits<float>::infinity()) {
  return {.origin = to_vec3f(origin), .direction = to_vec3f(direction), .t_min = t_min, .t_max = t_max};
}

/// @cond
// clang-format off
template <class Origin, class Direction> requires(!VectorOf<Origin, float> || !VectorOf<Direction, float>)
Ray to_ray(const Origin&, const Direction&, float = 0, float = 0) = delete;  // not three floats: round doubles with static_cast, or use to_double_ray and Bvh::to_local
// clang-format on
/// @endcond

/// A ray in double precision from any two vectors of three doubles or floats, for `Bvh::to_local`.
template <class Origin, class Direction>
constexpr DoubleRay to_double_ray(const Origin& origin, const Direction& direction, double t_min = 0.0,
                                  double t_max = std::numeric_limits<double>::infinity()) {
  return {.origin = to_vec3d(origin), .direction = to_vec3d(direction), .t_min = t_min, .t_max = t_max};
}

}  // namespace kerf

#endif  // KERF_HAS_CPP20
