// Questions of boxes, of other hierarchies, and of triangles by their numbers.
#include <cstring>
#include <vector>

#include <nanobind/stl/array.h>

#include "arrays.hpp"

namespace kerf::python {
namespace {

static_assert(sizeof(Box3f) == 6 * sizeof(float));

nb::tuple triangles_in(const Hierarchy& hierarchy, const Numbers<float>& boxes, unsigned threads) {
  const Bvh bvh = hierarchy.now();
  const std::span<const Box3f> span(reinterpret_cast<const Box3f*>(boxes.data()), boxes.size() / 6);
  return to_tuple(list_in_slices<PrimitiveId>(span.size(), [&](std::size_t first, std::size_t count) {
    return bvh.triangles_in(span.subspan(first, count), {.threads = threads});
  }));
}

Transform transform_of(const std::array<double, 12>& numbers) {
  Transform transform;
  std::memcpy(transform.rows, numbers.data(), sizeof(transform.rows));
  return transform;
}

nb::ndarray<nb::numpy, std::uint8_t, nb::ndim<1>> touching_pairs(const Hierarchy& hierarchy,
                                                                 const Hierarchy& others,
                                                                 const std::array<double, 12>& transform) {
  const Bvh bvh = hierarchy.now(), other = others.now();
  return to_bytes(unlocked([&] { return bvh.touching_pairs(other, transform_of(transform)); }));
}

bool touches(const Hierarchy& hierarchy, const Hierarchy& others, const std::array<double, 12>& transform) {
  const Bvh bvh = hierarchy.now(), other = others.now();
  return unlocked([&] { return bvh.touches(other, transform_of(transform)); });
}

/// Writes the corners of the triangles that are in leaves.
void triangles(const Hierarchy& hierarchy, const Numbers<std::uint32_t>& primitive,
               const Numbers<std::uint32_t>& mesh, Answers<float> corners) {
  const Bvh bvh = hierarchy.now();
  in_slices(primitive.shape(0), [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const auto k = static_cast<std::int64_t>(i);
      const auto triangle = bvh.triangle(
          {.primitive = primitive.data()[k * primitive.stride(0)], .mesh = mesh.data()[k * mesh.stride(0)]});
      if (triangle) std::memcpy(corners.data() + 9 * i, &*triangle, sizeof(*triangle));
    }
  });
}

}  // namespace

void add_shape_queries(nb::module_& module) {
  module.def("triangles_in", &triangles_in);
  module.def("touching_pairs", &touching_pairs);
  module.def("touches", &touches);
  module.def("triangles", &triangles);
}

}  // namespace kerf::python
