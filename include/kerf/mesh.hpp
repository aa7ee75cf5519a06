// Triangle meshes as kerf sees them: views of memory that the caller owns.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>  // with the concepts of ranges, without <ranges>, which takes longer than all of kerf
#include <type_traits>
#include <utility>

#include <kerf/error.hpp>
#include <kerf/ray.hpp>
#include <kerf/triples.hpp>

namespace kerf {

/// A view of triples of `Scalar` (three floats, three indices) at a constant distance in bytes. Nothing is
/// copied, and the memory must outlive the view.
///
/// Made from a contiguous range of scalars (`std::vector<float>`, three after three); of triples (arrays of
/// three, `glm::vec3`, `Eigen::Vector3f`) or of structs that begin with one (a vertex with a normal behind
/// its position); from a matrix of Eigen with a triple in each row and row-major, or in each column and
/// column-major; or from an address. What would be read as something else does not compile.
template <class Scalar>
class TripleView {
 public:
  /// One triple, copied.
  struct Triple {
    Scalar values[3];  ///< in the order in which they lie in memory
  };

  constexpr TripleView() = default;

  /// The triples of a range or a matrix, see above. Throws `Error::invalid_argument` for a flat range whose
  /// size is no multiple of three.
  template <class Range>
  requires(!std::same_as<std::remove_cvref_t<Range>, TripleView> && TriplesOf<Range, Scalar> &&
           (std::is_lvalue_reference_v<Range> || std::ranges::borrowed_range<Range>))
      TripleView(Range&& range) {  // NOLINT: implicit, as for std::span
    if constexpr (triples::Matrix<std::remove_cvref_t<Range>>) {
      if (range.innerStride() != 1) refuse("the scalars of a triple do not lie beside each other");
      *this =
          TripleView(range.data(), static_cast<std::size_t>(range.IsRowMajor ? range.rows() : range.cols()),
                     static_cast<std::size_t>(range.outerStride()) * sizeof(Scalar));
    } else if constexpr (triples::Flat<Range, Scalar>) {
      if (std::ranges::size(range) % 3 != 0) refuse("the size of a flat range is no multiple of three");
      *this = TripleView(std::ranges::data(range), std::ranges::size(range) / 3);
    } else {
      *this = TripleView(std::ranges::data(range), std::ranges::size(range));
    }
  }

  /// `count` triples from the address of the first scalar on, each `stride` bytes after the one before.
  template <ScalarOf<Scalar> T>
  TripleView(const T* data, std::size_t count, std::size_t stride = 3 * sizeof(Scalar))
      : data_(reinterpret_cast<const std::byte*>(data)), count_(count), stride_(stride) {}

  /// The triples with which `count` objects begin, each `stride` bytes after the one before.
  template <TripleOf<Scalar> T>
  TripleView(const T* data, std::size_t count, std::size_t stride = sizeof(T))
      : data_(reinterpret_cast<const std::byte*>(data)), count_(count), stride_(stride) {
    if (count != 0) data_ += triples::offset<T, Scalar>();
  }

  /// `count` triples in memory whose type is not known: nothing checks that they are floats or 32-bit
  /// indices.
  template <triples::RawMemory T>
  requires(!triples::is_wide<Scalar>) TripleView(const T* data, std::size_t count, std::size_t stride)
      : data_(reinterpret_cast<const std::byte*>(data)), count_(count), stride_(stride) {}

  /// @cond
  // What does not compile, in lines that compilers show with the remedy at their end.
  // clang-format off
  template <class R> requires(triples::Temporary<R, TripleView>)
  TripleView(R&&) = delete;  // a temporary: it dies before the view is read, so keep it in a variable

  template <class R> requires(triples::Refused<R, Scalar, TripleView> && TriplesOf<R, triples::Wider<Scalar>>)
  TripleView(R&&) = delete;  // doubles or 64-bit indices: kerf::DoubleMesh takes both; or copy them to floats and 32-bit indices

  template <class R> requires(triples::Refused<R, Scalar, TripleView> && triples::Matrix<std::remove_cvref_t<R>> && !TriplesOf<R, triples::Wider<Scalar>>)
  TripleView(R&&) = delete;  // a matrix: it needs a triple per row and RowMajor, or a triple per column and ColMajor

  template <class R> requires(triples::Refused<R, Scalar, TripleView> && !triples::Matrix<std::remove_cvref_t<R>> && !TriplesOf<R, triples::Wider<Scalar>>)
  TripleView(R&&) = delete;  // not three floats, or three 32-bit indices: copy them, or give address, count and stride

  template <class T> requires(!triples::is_wide<Scalar> && !ScalarOf<T, Scalar> && !TripleOf<T, Scalar> && !triples::RawMemory<T>)
  TripleView(const T*, std::size_t, std::size_t = 0) = delete;  // an address of what is not floats, or 32-bit indices: copy them
  // clang-format on
  /// @endcond

  std::size_t size() const { return count_; }      ///< number of triples
  std::size_t stride() const { return stride_; }   ///< bytes from one triple to the next
  const std::byte* data() const { return data_; }  ///< address of the first triple

  /// Triple `i`, `i < size()`.
  Triple operator[](std::size_t i) const {
    // Number by number: what is copied at once goes through memory, from where its parts are read again.
    const std::byte* const from = data_ + i * stride_;
    Triple triple;
    std::memcpy(&triple.values[0], from, sizeof(Scalar));
    std::memcpy(&triple.values[1], from + sizeof(Scalar), sizeof(Scalar));
    std::memcpy(&triple.values[2], from + 2 * sizeof(Scalar), sizeof(Scalar));
    return triple;
  }

 private:
  [[noreturn]] static void refuse(const char* why) { throw Error(Error::invalid_argument, why); }

  const std::byte* data_ = nullptr;
  std::size_t count_ = 0;
  std::size_t stride_ = 3 * sizeof(Scalar);
};

/// One indexed triangle mesh in the caller's memory, which must stay as it is until the build has returned.
struct TriangleMesh {
  TripleView<float> vertices;           ///< positions, in any unit; each coordinate below 2^126
  TripleView<std::uint32_t> triangles;  ///< three vertex numbers each, all below `vertices.size()`
  Mask mask = {};                       ///< rays that are traced with a `Mask` see it if they share a bit
};

/// A view of triples of vertex numbers, of 32 or 64 bits each.
class IndexView {
 public:
  IndexView() = default;

  /// From whatever makes a `TripleView` of 32-bit integers.
  template <class... From>
  requires std::constructible_from<TripleView<std::uint32_t>, From...> IndexView(
      From&&... from)  // NOLINT: implicit, as for a view
      : narrow_(std::forward<From>(from)...) {}

  /// From whatever makes a `TripleView` of 64-bit integers.
  template <class... From>
  requires std::constructible_from<TripleView<std::uint64_t>, From...> IndexView(
      From&&... from)  // NOLINT: implicit, as for a view
      : wide_(std::forward<From>(from)...), is_wide_(true) {}

  bool is_wide() const { return is_wide_; }                                      ///< of 64-bit integers
  std::size_t size() const { return is_wide_ ? wide_.size() : narrow_.size(); }  ///< number of triples
  const TripleView<std::uint32_t>& narrow() const { return narrow_; }            ///< those of 32 bits
  const TripleView<std::uint64_t>& wide() const { return wide_; }                ///< those of 64 bits

 private:
  TripleView<std::uint32_t> narrow_;
  TripleView<std::uint64_t> wide_;
  bool is_wide_ = false;
};

/// An indexed triangle mesh in double precision, for scenes far from the origin (maps, buildings at their
/// surveyed place). The hierarchy is built in a local frame of floats, whose place `Bvh::origin` tells.
struct DoubleMesh {
  TripleView<double> vertices;  ///< positions, in any unit; each coordinate below 2^126
  IndexView triangles;          ///< three vertex numbers each, all below `vertices.size()`
  Mask mask = {};               ///< as that of a `TriangleMesh`
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
