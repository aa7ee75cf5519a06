// Many questions in one call: how it runs, where its rays lie and where its answers go. All are views of the
// caller's memory, of plain addresses and distances, as other languages have them at hand.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>  // with the concepts of ranges, without <ranges>, which takes longer than all of kerf
#include <type_traits>
#include <utility>
#include <vector>

#include <kerf/mesh.hpp>
#include <kerf/ray.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// How a call for many questions runs.
struct BatchOptions {
  /// Threads to use; 0 uses all, or inside a caller's oneTBB task arena those of the arena. The answers are
  /// the same for any number. A number other than that of the caller's arena costs some 0.1 ms a call.
  unsigned threads = 0;
};

/// One number for each of many rays or hits.
template <class T>
struct Column {
  T* data = nullptr;                  ///< the first one, at any address; or null, see where it stands
  std::ptrdiff_t stride = sizeof(T);  ///< bytes from one to the next; may be 0 or negative
};

/// Many rays, each of their numbers anywhere: an array of `Ray`, six floats a ray, an array for each
/// component.
struct RayView {
  std::size_t count = 0;             ///< number of rays
  Column<const float> origin[3];     ///< x, y and z
  Column<const float> direction[3];  ///< x, y and z
  Column<const float> t_min;         ///< null: 0 for all
  Column<const float> t_max;         ///< null: infinity for all
  /// `Mask::bits` of each ray, for `intersect` and `occluded`; null: all bits for all.
  Column<const std::uint32_t> mask;

  RayView() = default;

  /// A contiguous range of `Ray`.
  template <std::ranges::contiguous_range Range>
  requires(std::same_as<std::ranges::range_value_t<Range>, Ray>)
      RayView(Range&& range)  // NOLINT: implicit, as for std::span
      : count(std::ranges::size(range)) {
    if (count == 0) return;
    const Ray& first = *std::ranges::data(range);
    constexpr auto stride = static_cast<std::ptrdiff_t>(sizeof(Ray));
    origin[0] = {&first.origin.x, stride};
    origin[1] = {&first.origin.y, stride};
    origin[2] = {&first.origin.z, stride};
    direction[0] = {&first.direction.x, stride};
    direction[1] = {&first.direction.y, stride};
    direction[2] = {&first.direction.z, stride};
    t_min = {&first.t_min, stride};
    t_max = {&first.t_max, stride};
  }

  /// `count` rays of six floats in a row, the origin first; each ray `stride` bytes after the one before.
  static RayView six_floats(const float* rays, std::size_t count, std::ptrdiff_t stride = 6 * sizeof(float)) {
    return origins_and_directions(rays, count == 0 ? nullptr : rays + 3, count, stride, stride);
  }

  /// `count` rays whose origins and directions are arrays of three floats in a row, with their own strides in
  /// bytes. A stride of 0 stands for one origin, or direction, of all.
  static RayView origins_and_directions(const float* origins, const float* directions, std::size_t count,
                                        std::ptrdiff_t origin_stride = 3 * sizeof(float),
                                        std::ptrdiff_t direction_stride = 3 * sizeof(float)) {
    RayView view;
    view.count = count;
    if (count == 0) return view;
    for (int axis = 0; axis < 3; ++axis) {
      view.origin[axis] = {origins + axis, origin_stride};
      view.direction[axis] = {directions + axis, direction_stride};
    }
    return view;
  }
};

/// Many points: whatever a `TripleView<float>` is made from, or one.
class PointView {
 public:
  /// The points of whatever a `TripleView<float>` is made from.
  template <class Points>
  requires(!std::same_as<std::remove_cvref_t<Points>, PointView> &&
           std::constructible_from<TripleView<float>, Points>)
      PointView(Points&& points)  // NOLINT: implicit, as for std::span
      : triples_(std::forward<Points>(points)) {}

  std::size_t size() const { return triples_.size(); }  ///< number of points
  /// Point `i`, `i < size()`.
  Vec3f operator[](std::size_t i) const {
    const auto [point] = triples_[i];
    return {point[0], point[1], point[2]};
  }

 private:
  TripleView<float> triples_;
};

/// Where the hits of many rays go: an array of `Hit`, or an array for each field. A field whose address is
/// null is not written.
struct HitView {
  std::size_t count = 0;            ///< number of hits
  Column<float> t;                  ///< infinity for a miss
  Column<float> u;                  ///< 0 for a miss
  Column<float> v;                  ///< 0 for a miss
  Column<std::uint32_t> primitive;  ///< `invalid_id` for a miss
  Column<std::uint32_t> mesh;       ///< `invalid_id` for a miss

  HitView() = default;

  /// A contiguous range of `Hit`.
  template <std::ranges::contiguous_range Range>
  requires(std::same_as<std::ranges::range_value_t<Range>, Hit> &&
           !std::is_const_v<std::remove_reference_t<std::ranges::range_reference_t<Range>>>)
      HitView(Range&& range)  // NOLINT: implicit, as for std::span
      : count(std::ranges::size(range)) {
    if (count == 0) return;
    Hit& first = *std::ranges::data(range);
    constexpr auto stride = static_cast<std::ptrdiff_t>(sizeof(Hit));
    t = {&first.t, stride};
    u = {&first.u, stride};
    v = {&first.v, stride};
    primitive = {&first.primitive, stride};
    mesh = {&first.mesh, stride};
  }
};

/// What holds a yes or a no in one byte: 1 or 0, `true` or `false`.
template <class T>
concept Flag = std::same_as<T, bool> || std::same_as<T, std::byte> || std::same_as<T, char> ||
    std::same_as<T, signed char> || std::same_as<T, unsigned char>;

/// Where many answers of yes or no go: a contiguous range of `bool`, `std::byte`, `std::uint8_t` or `char`
/// (not `std::vector<bool>`, which holds bits), or an address and a distance.
class FlagView {
 public:
  /// All of a range.
  template <std::ranges::contiguous_range Range>
  requires(Flag<std::ranges::range_value_t<Range>> &&
           !std::is_const_v<std::remove_reference_t<std::ranges::range_reference_t<Range>>>)
      FlagView(Range&& range)  // NOLINT: implicit, as for std::span
      : FlagView(std::ranges::data(range), std::ranges::size(range)) {}

  /// `count` flags, each `stride` bytes after the one before.
  template <Flag T>
  FlagView(T* data, std::size_t count, std::ptrdiff_t stride = 1)
      : data_(reinterpret_cast<unsigned char*>(data)), count_(count), stride_(stride) {}

  std::size_t size() const { return count_; }        ///< number of flags
  std::ptrdiff_t stride() const { return stride_; }  ///< bytes from one flag to the next
  unsigned char* data() const { return data_; }      ///< address of the first
  /// Writes flag `i`, `i < size()`.
  void set(std::size_t i, bool flag) const { data_[static_cast<std::ptrdiff_t>(i) * stride_] = flag ? 1 : 0; }

 private:
  unsigned char* data_;
  std::size_t count_;
  std::ptrdiff_t stride_;
};

/// A list of answers for each of many questions, one after the other.
template <class T>
struct Lists {
  std::vector<std::size_t> offsets{0};  ///< where each list begins in `items`; one more ends the last
  std::vector<T> items;                 ///< all lists, in the order of the questions

  std::size_t size() const { return offsets.size() - 1; }  ///< number of lists
  /// List `i`, `i < size()`.
  std::span<const T> operator[](std::size_t i) const {
    return {items.data() + offsets[i], offsets[i + 1] - offsets[i]};
  }
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
