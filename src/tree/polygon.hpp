// The convex polygon that is the part of a triangle in a box, in double precision. It is for measuring and
// checking trees, which needs areas. Builders chop in single precision, conservatively (math/clip.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "math/triangle.hpp"

namespace kerf {

struct Polygon {
  using Point = std::array<double, 3>;

  // A triangle cut by six planes has up to nine vertices. Cutting again what rounding left beside a plane can
  // double a few. Vertices beyond the capacity are within rounding of their neighbours and may be left out.
  static constexpr std::size_t capacity = 24;

  std::array<Point, capacity> points;
  std::size_t count = 0;

  Polygon() = default;
  explicit Polygon(const Triangle& triangle) {
    for (const Vec3f& v : {triangle.v0, triangle.v1, triangle.v2}) append({v.x, v.y, v.z});
  }

  void append(const Point& p) {
    if (count < capacity) points[count++] = p;
  }

  double lower(int axis) const {
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count; ++i) smallest = std::min(smallest, at(i, axis));
    return smallest;
  }
  double upper(int axis) const {
    double largest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count; ++i) largest = std::max(largest, at(i, axis));
    return largest;
  }

  double area() const {
    Point sum{};
    for (std::size_t i = 2; i < count; ++i) {
      const Point u = difference(i - 1), v = difference(i);
      sum[0] += u[1] * v[2] - u[2] * v[1];
      sum[1] += u[2] * v[0] - u[0] * v[2];
      sum[2] += u[0] * v[1] - u[1] * v[0];
    }
    return 0.5 * std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  }

  double at(std::size_t i, int axis) const { return points[i][static_cast<std::size_t>(axis)]; }

 private:
  Point difference(std::size_t i) const {
    return {points[i][0] - points[0][0], points[i][1] - points[0][1], points[i][2] - points[0][2]};
  }
};

/// The part on the side of the plane `x[axis] = position` where `sign * (x[axis] - position) <= 0`, borders
/// included (Sutherland & Hodgman 1974).
inline Polygon clip(const Polygon& polygon, int axis, double position, double sign) {
  Polygon part;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const std::size_t j = i + 1 == polygon.count ? 0 : i + 1;
    const double a = sign * (polygon.at(i, axis) - position), b = sign * (polygon.at(j, axis) - position);
    if (a <= 0.0) part.append(polygon.points[i]);
    if ((a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)) {
      const double t = a / (a - b);
      Polygon::Point crossing;
      for (std::size_t k = 0; k < 3; ++k) {
        crossing[k] = polygon.points[i][k] + t * (polygon.points[j][k] - polygon.points[i][k]);
      }
      crossing[static_cast<std::size_t>(axis)] = position;
      part.append(crossing);
    }
  }
  return part;
}

/// Whether all of it lies inside `box`, borders included: it is then its own part there.
inline bool is_inside(const Polygon& polygon, const Box3f& box) {
  for (std::size_t i = 0; i < polygon.count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(polygon.at(i, axis) >= box.lower[axis] && polygon.at(i, axis) <= box.upper[axis])) return false;
    }
  }
  return true;
}

/// The part inside `box`, borders included.
inline Polygon clip(Polygon polygon, const Box3f& box) {
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = polygon.lower(axis), upper = polygon.upper(axis);
    if (!(lower <= box.upper[axis] && upper >= box.lower[axis])) return {};
    if (lower < box.lower[axis]) polygon = clip(polygon, axis, box.lower[axis], -1.0);
    if (upper > box.upper[axis]) polygon = clip(polygon, axis, box.upper[axis], 1.0);
  }
  return polygon;
}

}  // namespace kerf
