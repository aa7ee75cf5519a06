// NumPy's arrays as kerf's views and back. What arrives here has been brought into shape by
// kerf_bvh/_arrays.py: types are those named, lengths agree, addresses are aligned.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <kerf/kerf.hpp>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>

namespace kerf::python {

namespace nb = nanobind;

/// A hierarchy that a thread may refit while others ask it: what they ask is answered for all corners as they
/// were before or for all as they are after.
class Hierarchy {
 public:
  Hierarchy() = default;
  explicit Hierarchy(Bvh bvh) : bvh_(std::move(bvh)) {}

  /// A handle of its own for a call, so that a refit that begins meanwhile works on a copy. One that goes on
  /// already is waited for, without Python's lock.
  Bvh now() const {
    std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) {
      const nb::gil_scoped_release unlocked;
      lock.lock();
    }
    return bvh_;
  }

  /// Without Python's lock.
  RefitReport refit(std::span<const TriangleMesh> meshes, const BuildOptions& options) {
    const std::lock_guard lock(mutex_);
    return kerf::refit(bvh_, meshes, options);
  }

 private:
  Bvh bvh_;
  mutable std::mutex mutex_;
};

/// n triples of floats at any strides: origins, directions, points.
using Triples = nb::ndarray<const float, nb::shape<-1, 3>, nb::device::cpu>;
/// One number a ray, at any stride; a stride of 0 stands for one number of all.
template <class T>
using Numbers = nb::ndarray<const T, nb::ndim<1>, nb::device::cpu>;
/// Where answers go: contiguous, written to.
template <class T>
using Answers = nb::ndarray<T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
/// The same of records, as bytes.
using Bytes = Answers<std::uint8_t>;

/// The bytes between two elements of an array along an axis.
template <class Array>
std::ptrdiff_t stride_in_bytes(const Array& array, std::size_t axis) {
  return static_cast<std::ptrdiff_t>(array.stride(axis)) * static_cast<std::ptrdiff_t>(array.itemsize());
}

template <class T>
Column<const T> column(const std::optional<Numbers<T>>& numbers) {
  if (!numbers) return {};
  return {numbers->data(), stride_in_bytes(*numbers, 0)};
}

/// Records of the library's types in an array of bytes.
template <class T>
std::span<T> records(const Bytes& bytes) {
  return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
}

/// Answer `first` and on of a column, whose address may be null.
template <class T>
Column<T> from(const Column<T>& column, std::size_t first) {
  if (column.data == nullptr) return column;
  using Byte = std::conditional_t<std::is_const_v<T>, const std::byte, std::byte>;
  return {reinterpret_cast<T*>(reinterpret_cast<Byte*>(column.data) +
                               static_cast<std::ptrdiff_t>(first) * column.stride),
          column.stride};
}

/// `count` points whose coordinates lie beside each other.
inline PointView points_of(const Triples& points, std::size_t first, std::size_t count) {
  const auto stride = stride_in_bytes(points, 0);
  const auto* data =
      reinterpret_cast<const std::byte*>(points.data()) + static_cast<std::ptrdiff_t>(first) * stride;
  return TripleView<float>(reinterpret_cast<const float*>(data), count, static_cast<std::size_t>(stride));
}

/// Calls `call(first, count)` for one slice of many questions after the other, without Python's lock. Between
/// slices signals are looked at, so that Ctrl-C ends a long call.
template <class Call>
void in_slices(std::size_t count, const Call& call) {
  constexpr std::size_t slice = std::size_t{1} << 20;
  for (std::size_t first = 0; first < count; first += slice) {
    {
      const nb::gil_scoped_release unlocked;
      call(first, std::min(slice, count - first));
    }
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  }
}

/// The same of answers that are lists: `call(first, count)` returns those of a slice.
template <class T, class Call>
Lists<T> list_in_slices(std::size_t count, const Call& call) {
  constexpr std::size_t slice = std::size_t{1} << 16;
  Lists<T> all;
  if (count > slice) {  // what no memory can hold is refused at once, not after hours
    try {
      all.offsets.reserve(count + 1);
    } catch (const std::exception&) {
      throw Error(Error::out_of_memory,
                  "not enough memory for the lists of " + std::to_string(count) + " questions");
    }
  }
  for (std::size_t first = 0; first < count || first == 0; first += slice) {
    {
      const nb::gil_scoped_release unlocked;
      Lists<T> part = call(first, std::min(slice, count - first));
      if (count <= slice) {
        all = std::move(part);
      } else {
        const std::size_t before = all.items.size();
        for (std::size_t i = 1; i < part.offsets.size(); ++i) all.offsets.push_back(before + part.offsets[i]);
        all.items.insert(all.items.end(), part.items.begin(), part.items.end());
      }
    }
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  }
  return all;
}

/// The items of a vector as bytes; their memory passes to the array.
template <class T>
nb::ndarray<nb::numpy, std::uint8_t, nb::ndim<1>> to_bytes(std::vector<T>&& items) {
  auto owned = std::make_unique<std::vector<T>>(std::move(items));
  auto* data = reinterpret_cast<std::uint8_t*>(owned->data());
  const std::size_t size = owned->size() * sizeof(T);
  const nb::capsule owner(owned.get(),
                          [](void* vector) noexcept { delete static_cast<std::vector<T>*>(vector); });
  owned.release();
  return {data, {size}, owner};
}

/// Offsets and items.
template <class T>
nb::tuple to_tuple(Lists<T>&& lists) {
  return nb::make_tuple(to_bytes(std::move(lists.offsets)), to_bytes(std::move(lists.items)));
}

/// Calls that return what is made without Python's lock.
template <class Make>
auto unlocked(const Make& make) {
  const nb::gil_scoped_release unlocked;
  return make();
}

// The parts of the module, each in its file.
void add_build(nb::module_& module);
void add_ray_queries(nb::module_& module);
void add_point_queries(nb::module_& module);
void add_shape_queries(nb::module_& module);
void add_scene(nb::module_& module);
void add_cuda(nb::module_& module);  // where KERF_BINDINGS_CUDA is ON

}  // namespace kerf::python
