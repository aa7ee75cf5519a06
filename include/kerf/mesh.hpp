// Triangle meshes as kerf sees them: views of memory that the caller owns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <ranges>
#include <type_traits>

#include <kerf/vec.hpp>

namespace kerf {

/// A view of triples of `Scalar` (three floats, three indices) at a constant distance in bytes. Nothing is
/// copied.
///
/// Made from any contiguous range: of scalars (`std::vector<float>`, three after three), or of a struct or an
/// array whose first three scalars are the triple (`std::array<float, 3>`, `glm::vec3`, a vertex with a
/// normal behind its position).
template <class Scalar>
class TripleView {
 public:
  /// One triple, copied.
  struct Triple {
    Scalar values[3];  ///< in the order in which they lie in memory
  };

  constexpr TripleView() = default;

  /// `count` triples, the first at `data`, each `stride` bytes after the one before.
  TripleView(const void* data, std::size_t count, std::size_t stride = 3 * sizeof(Scalar))
      : data_(static_cast<const std::byte*>(data)), count_(count), stride_(stride) {}

  /// The triples of a contiguous range, whose memory must outlive the view. The element's type decides how
  /// the range is read, see above.
  template <std::ranges::contiguous_range Range>
  requires(!std::is_same_v<std::remove_cvref_t<Range>, TripleView>)
      TripleView(Range&& range)  // NOLINT: implicit, as for std::span
      : data_(reinterpret_cast<const std::byte*>(std::ranges::data(range))) {
    using Value = std::ranges::range_value_t<Range>;
    if constexpr (std::is_arithmetic_v<Value>) {
      static_assert(
          std::is_same_v<std::make_unsigned_t<std::conditional_t<std::is_integral_v<Value>, Value, int>>,
                         std::conditional_t<std::is_integral_v<Scalar>, Scalar, unsigned>> &&
              std::is_floating_point_v<Value> == std::is_floating_point_v<Scalar> &&
              sizeof(Value) == sizeof(Scalar),
          "a flat range must hold scalars of the view's own type");
      count_ = std::ranges::size(range) / 3;
      stride_ = 3 * sizeof(Scalar);
    } else {
      static_assert(std::is_trivially_copyable_v<Value> && sizeof(Value) >= 3 * sizeof(Scalar),
                    "an element must begin with three scalars");
      count_ = std::ranges::size(range);
      stride_ = sizeof(Value);
    }
  }

  std::size_t size() const { return count_; }      ///< number of triples
  std::size_t stride() const { return stride_; }   ///< bytes from one triple to the next
  const std::byte* data() const { return data_; }  ///< address of the first triple

  /// Triple `i`, `i < size()`.
  Triple operator[](std::size_t i) const {
    Triple triple;
    std::memcpy(&triple, data_ + i * stride_, sizeof(triple));
    return triple;
  }

 private:
  const std::byte* data_ = nullptr;
  std::size_t count_ = 0;
  std::size_t stride_ = 3 * sizeof(Scalar);
};

/// One indexed triangle mesh in the caller's memory, which must stay as it is until the build has returned.
struct TriangleMesh {
  TripleView<float> vertices;           ///< positions, in any unit; each coordinate below 2^126
  TripleView<std::uint32_t> triangles;  ///< three vertex numbers each, all below `vertices.size()`
};

}  // namespace kerf
