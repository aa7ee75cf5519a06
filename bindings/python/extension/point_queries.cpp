// Questions of points.
#include <cmath>
#include <vector>

#include "arrays.hpp"

namespace kerf::python {
namespace {

void contains(const Hierarchy& hierarchy, const Triples& points, Bytes inside, unsigned threads) {
  const Bvh bvh = hierarchy.now();
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    bvh.contains(points_of(points, first, count), FlagView(inside.data() + first, count),
                 {.threads = threads});
  });
}

void side(const Hierarchy& hierarchy, const Triples& points, Bytes sides, unsigned threads) {
  const Bvh bvh = hierarchy.now();
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    bvh.side(points_of(points, first, count), records<Side>(sides).subspan(first, count),
             {.threads = threads});
  });
}

void signed_distance(const Hierarchy& hierarchy, const Triples& points, Answers<float> distances,
                     unsigned threads) {
  const Bvh bvh = hierarchy.now();
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    bvh.signed_distance(points_of(points, first, count), {distances.data() + first, count},
                        {.threads = threads});
  });
}

void closest_point(const Hierarchy& hierarchy, const Triples& points, Bytes closest, float max_distance,
                   unsigned threads) {
  const Bvh bvh = hierarchy.now();
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    bvh.closest_point(points_of(points, first, count), records<SurfacePoint>(closest).subspan(first, count),
                      max_distance, {.threads = threads});
  });
}

nb::tuple nearest(const Hierarchy& hierarchy, const Triples& points, std::size_t count, float max_distance,
                  unsigned threads) {
  const Bvh bvh = hierarchy.now();
  return to_tuple(list_in_slices<SurfacePoint>(points.shape(0), [&](std::size_t first, std::size_t some) {
    return bvh.nearest(points_of(points, first, some), count, max_distance, {.threads = threads});
  }));
}

nb::tuple within(const Hierarchy& hierarchy, const Triples& points, float radius, unsigned threads) {
  const Bvh bvh = hierarchy.now();
  return to_tuple(list_in_slices<SurfacePoint>(points.shape(0), [&](std::size_t first, std::size_t count) {
    return bvh.within(points_of(points, first, count), radius, {.threads = threads});
  }));
}

/// Points in the coordinates of the meshes as the hierarchy takes them.
void to_local(const Hierarchy& hierarchy, nb::ndarray<const double, nb::shape<-1, 3>, nb::device::cpu> points,
              Answers<float> local) {
  const Bvh bvh = hierarchy.now();
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const double* point = points.data() + static_cast<std::int64_t>(i) * points.stride(0);
      const Vec3f moved = bvh.to_local(Vec3d{point[0], point[points.stride(1)], point[2 * points.stride(1)]});
      for (int axis = 0; axis < 3; ++axis) local.data()[3 * i + static_cast<std::size_t>(axis)] = moved[axis];
    }
  });
}

struct Point {
  double x, y, z;

  friend Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Point operator*(double s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
};

// Ericson 2005, "Real-Time Collision Detection", section 5.1.5.
Point closest_on_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
  const Point ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac;
}

/// Closest points in double precision, of triangles that are known already.
void closest_on_triangles(Answers<const double> points, Answers<const double> corners,
                          Answers<const std::int64_t> ids, Answers<double> closest,
                          Answers<double> distances) {
  static_assert(sizeof(Point) == 3 * sizeof(double));
  const auto* from = reinterpret_cast<const Point*>(points.data());
  const auto* triangles = reinterpret_cast<const Point*>(corners.data());
  auto* to = reinterpret_cast<Point*>(closest.data());
  in_slices(ids.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const Point* triangle = triangles + 3 * ids.data()[i];
      to[i] = closest_on_triangle(from[i], triangle[0], triangle[1], triangle[2]);
      const Point apart = from[i] - to[i];
      distances.data()[i] = std::sqrt(dot(apart, apart));
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
  module.def("closest_on_triangles", &closest_on_triangles);
}

}  // namespace kerf::python
