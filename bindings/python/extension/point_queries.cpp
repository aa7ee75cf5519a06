// Questions of points.
#include <vector>

#include "arrays.hpp"

namespace kerf::python {
namespace {

template <class T>
std::span<T> records(const Bytes& bytes) {
  return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
}

void contains(const Bvh& bvh, const Triples& points, Bytes inside, unsigned threads) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    bvh.contains(points_of(points, first, count), FlagView(inside.data() + first, count),
                 {.threads = threads});
  });
}

void side(const Bvh& bvh, const Triples& points, Bytes sides, unsigned threads) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    bvh.side(points_of(points, first, count), records<Side>(sides).subspan(first, count),
             {.threads = threads});
  });
}

void signed_distance(const Bvh& bvh, const Triples& points, Answers<float> distances, unsigned threads) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    bvh.signed_distance(points_of(points, first, count), {distances.data() + first, count},
                        {.threads = threads});
  });
}

void closest_point(const Bvh& bvh, const Triples& points, Bytes closest, float max_distance,
                   unsigned threads) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    bvh.closest_point(points_of(points, first, count), records<SurfacePoint>(closest).subspan(first, count),
                      max_distance, {.threads = threads});
  });
}

nb::tuple nearest(const Bvh& bvh, const Triples& points, std::size_t count, float max_distance,
                  unsigned threads) {
  return to_tuple(unlocked([&] {
    return bvh.nearest(points_of(points, 0, points.shape(0)), count, max_distance, {.threads = threads});
  }));
}

nb::tuple within(const Bvh& bvh, const Triples& points, float radius, unsigned threads) {
  return to_tuple(unlocked(
      [&] { return bvh.within(points_of(points, 0, points.shape(0)), radius, {.threads = threads}); }));
}

/// Points in the coordinates of the meshes as the hierarchy takes them.
void to_local(const Bvh& bvh, nb::ndarray<const double, nb::shape<-1, 3>, nb::device::cpu> points,
              Answers<float> local) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const double* point = points.data() + static_cast<std::int64_t>(i) * points.stride(0);
      const Vec3f moved = bvh.to_local(Vec3d{point[0], point[points.stride(1)], point[2 * points.stride(1)]});
      for (int axis = 0; axis < 3; ++axis) local.data()[3 * i + static_cast<std::size_t>(axis)] = moved[axis];
    }
  });
}

}  // namespace

void add_point_queries(nb::module_& module) {
  module.def("contains", &contains);
  module.def("side", &side);
  module.def("signed_distance", &signed_distance);
  module.def("closest_point", &closest_point);
  module.def("nearest", &nearest);
  module.def("within", &within);
  module.def("to_local", &to_local);
}

}  // namespace kerf::python
