// Which types hold three scalars, and where in them these lie: for views of the caller's memory, and for
// conversions. Libraries of vectors and matrices are known by what their types offer, none by its name.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>  // with the concepts of ranges, without <ranges>, which takes longer than all of kerf
#include <type_traits>
#include <utility>

namespace kerf {

/// `T` is the scalar `Scalar`, or an integer that differs from it in its sign or its name only.
template <class T, class Scalar>
concept ScalarOf =
    std::same_as<T, Scalar> ||
    (std::integral<Scalar>&& std::signed_integral<T>&& std::same_as<std::make_unsigned_t<T>, Scalar>) ||
    (std::integral<Scalar> && std::unsigned_integral<T> && sizeof(T) == sizeof(Scalar) &&
     (std::same_as<T, unsigned int> || std::same_as<T, unsigned long> ||
      std::same_as<T, unsigned long long>));

/// @cond  not for callers
namespace triples {

template <class T>
using Element = std::remove_cvref_t<decltype(std::declval<T&>()[0])>;

/// How many scalars an array, a vector or a small matrix holds, where its type says so; else 0.
template <class T>
consteval std::size_t fixed_size() {
  if constexpr (std::is_array_v<T>) {
    return std::rank_v<T> == 1 ? std::extent_v<T> : 0;
  } else if constexpr (requires { T::SizeAtCompileTime; }) {
    return T::SizeAtCompileTime > 0 ? static_cast<std::size_t>(T::SizeAtCompileTime) : 0;
  } else if constexpr (requires { typename std::tuple_size<T>::type; }) {
    return std::tuple_size<T>::value;
  } else if constexpr (requires { typename std::integral_constant<int, static_cast<int>(T::length())>; }) {
    return static_cast<std::size_t>(T::length());
  } else if constexpr (requires { typename std::integral_constant<std::size_t, T::extent>; }) {
    return T::extent;
  } else {
    return 0;
  }
}

/// The same of an object that is nothing but its scalars.
template <class T>
consteval std::size_t size_in_memory() {
  if constexpr (fixed_size<T>() != 0) {
    return fixed_size<T>();
  } else {
    return sizeof(T) % sizeof(Element<T>) == 0 ? sizeof(T) / sizeof(Element<T>) : 0;
  }
}

/// It has members x, y and z.
template <class T>
concept NamesAxes = std::is_class_v<T> && requires(T& t) {
  t.x;
  t.y;
  t.z;
};

/// These are scalars, one behind the other.
template <class T, class Scalar>
concept HasMembers = NamesAxes<T> && std::is_standard_layout_v<T> && requires(T& t) {
  requires ScalarOf<std::remove_cvref_t<decltype((t.x))>, Scalar>;
  requires ScalarOf<std::remove_cvref_t<decltype((t.y))>, Scalar>;
  requires ScalarOf<std::remove_cvref_t<decltype((t.z))>, Scalar>;
  requires(offsetof(T, y) == offsetof(T, x) + sizeof(Scalar));
  requires(offsetof(T, z) == offsetof(T, x) + 2 * sizeof(Scalar));
};

/// It can be indexed, and holds its elements itself.
template <class T>
concept Indexed = std::is_array_v<T> ||
    (std::is_class_v<T>&& std::is_standard_layout_v<T>&& std::is_trivially_destructible_v<T> &&
     !std::ranges::borrowed_range<T> &&
     requires(T & t) { requires std::is_lvalue_reference_v<decltype(t[0])>; });

/// It is indexed and holds three scalars. Floats may have a fourth beside them, as padding. A fourth index
/// would be that of a quadrilateral.
template <class T, class Scalar>
concept IsArray = Indexed<T> && ScalarOf<Element<T>, Scalar> &&
    (size_in_memory<T>() == 3 || (size_in_memory<T>() == 4 && std::floating_point<Scalar>));

template <class T, class Scalar>
consteval bool begins_with_triple();

/// Initialises a scalar, and nothing else.
template <class Scalar>
struct AnyScalar {
  template <ScalarOf<Scalar> T>
  operator T() const;  // NOLINT: implicit
};

/// Initialises a member that begins with three scalars.
template <class Scalar, class Owner>
struct AnyTriple {
  template <class T>
  requires(!std::same_as<T, Owner> && begins_with_triple<T, Scalar>()) operator T()
      const;  // NOLINT: implicit
};

/// A struct without names for the axes.
template <class T>
concept IsStruct = std::is_class_v<T> && std::is_aggregate_v<T> && !Indexed<T> && !NamesAxes<T>;

/// Its first members are scalars, or arrays of them, at least as many as there are `AnyScalar`.
template <class T, class... AnyScalar>
concept BeginsWith = IsStruct<T> && requires(AnyScalar... any) {
  T{any...};
};

/// Its first members are the three scalars. A fourth index would be that of a quadrilateral.
template <class T, class Scalar, class Any = AnyScalar<Scalar>>
concept BeginsWithScalars = BeginsWith<T, Any, Any, Any> &&
    (std::floating_point<Scalar> || !BeginsWith<T, Any, Any, Any, Any>);

/// Its first member begins with three scalars.
template <class T, class Scalar>
concept BeginsWithTriple = IsStruct<T> && requires(AnyTriple<Scalar, T> any) {
  T{any};
};

template <class T, class Scalar>
consteval bool begins_with_triple() {
  if constexpr (HasMembers<T, Scalar>) {
    return !(std::integral<Scalar> && requires(T & t) { t.w; });
  } else {
    return IsArray<T, Scalar> || BeginsWithScalars<T, Scalar> || BeginsWithTriple<T, Scalar>;
  }
}

/// Where in an object the first of the three scalars lies.
template <class T, class Scalar>
consteval std::size_t offset() {
  if constexpr (HasMembers<T, Scalar>) {
    return offsetof(T, x);
  } else {
    return 0;
  }
}

/// A matrix in the manner of Eigen, its scalars in the caller's memory or its own.
template <class M>
concept Matrix = requires(const M& m) {
  typename M::Scalar;
  M::IsRowMajor;
  M::RowsAtCompileTime;
  M::ColsAtCompileTime;
  m.data();
  m.outerStride();
  m.innerStride();
};

/// Three scalars in each row, row after row, or in each column, column after column.
template <class M, class Scalar>
concept MatrixOfTriples = Matrix<M> && ScalarOf<typename M::Scalar, Scalar> &&
                          (M::IsRowMajor ? M::ColsAtCompileTime : M::RowsAtCompileTime) == 3;

template <class T, class Scalar>
concept Flat = std::ranges::contiguous_range<T> && ScalarOf<std::ranges::range_value_t<T>, Scalar>;

}  // namespace triples
/// @endcond

/// An object of type `T` begins with three scalars of type `Scalar` in its memory: members x, y and z; an
/// array, a vector or a point of three (floats: or four); or a struct that begins with one of these.
template <class T, class Scalar>
concept TripleOf = triples::begins_with_triple<std::remove_cv_t<T>, Scalar>();

/// A contiguous range of triples or of scalars, or a matrix of which each row or each column is a triple.
template <class T, class Scalar>
concept TriplesOf = triples::MatrixOfTriples<std::remove_cvref_t<T>, Scalar> || triples::Flat<T, Scalar> ||
    (std::ranges::contiguous_range<T>&& TripleOf<std::ranges::range_value_t<T>, Scalar>);

/// @cond  not for callers
namespace triples {

/// Memory whose type has been lost.
template <class T>
concept RawMemory = std::is_void_v<T> || std::same_as<T, std::byte> || std::same_as<T, char> ||
    std::same_as<T, unsigned char>;

/// A range or a matrix that is not `View` itself.
template <class R, class View>
concept Collection =
    !std::same_as<std::remove_cvref_t<R>, View> && (std::ranges::range<R> || Matrix<std::remove_cvref_t<R>>);

/// A collection that owns its memory and ends with the expression that it stands in.
template <class R, class View>
concept Temporary = Collection<R, View> && !std::is_lvalue_reference_v<R> && !std::ranges::borrowed_range<R>;

/// The scalar of twice the width.
template <class Scalar>
using Wider = std::conditional_t<std::floating_point<Scalar>, double, std::uint64_t>;

/// Views of wide scalars refuse by being no candidates, so that a mesh given in braces is that of the view
/// which takes it. Memory without a type is never wide.
template <class Scalar>
inline constexpr bool is_wide = std::same_as<Scalar, Wider<Scalar>>;

/// A collection that outlives the view, but does not hold triples of `Scalar`.
template <class R, class Scalar, class View>
concept Refused = Collection<R, View> && !Temporary<R, View> && !TriplesOf<R, Scalar> && !is_wide<Scalar>;

}  // namespace triples
/// @endcond

}  // namespace kerf

#endif  // KERF_HAS_CPP20
