// Geometry in rational numbers: what is true of the floats that kerf was given, found by formulas other than
// its own.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <boost/multiprecision/gmp.hpp>

#include "math/triangle.hpp"

namespace exact {

using Number = boost::multiprecision::mpq_rational;

struct Vector {
  Number x, y, z;

  const Number& operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

inline Number number(float x) {
  return Number(x);
}
inline Vector vector(const kerf::Vec3f& a) {
  return {number(a.x), number(a.y), number(a.z)};
}
inline Vector operator+(const Vector& a, const Vector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector operator-(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vector operator*(const Number& s, const Vector& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline Number dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// How a line meets a triangle.
enum class Meeting {
  none,      ///< no common point, or the line lies in the triangle's plane
  boundary,  ///< through an edge or a vertex
  interior,  ///< through a point inside
};

struct Crossing {
  Meeting meeting = Meeting::none;
  Number t, u, v;  ///< valid unless `none`
};

/// How far `t` is from the exact value, in units in the last place of the exact value's float.
inline double error_in_ulps(float t, const Number& truth) {
  const auto nearest = static_cast<float>(truth.convert_to<double>());
  const float above = std::nextafter(std::abs(nearest), std::numeric_limits<float>::infinity());
  const Number ulp = number(above) - number(std::abs(nearest));
  return std::abs(Number((number(t) - truth) / ulp).convert_to<double>());
}

/// By the plane's equation and barycentric coordinates as ratios of areas.
inline Crossing cross_line(const kerf::Vec3f& origin, const kerf::Vec3f& direction,
                           const kerf::Triangle& triangle) {
  const Vector o = vector(origin), d = vector(direction);
  const Vector a = vector(triangle.v0), b = vector(triangle.v1), c = vector(triangle.v2);
  const Vector n = cross(b - a, c - a);
  const Number slope = dot(n, d);
  if (slope == 0) return {};
  Crossing crossing;
  crossing.t = dot(n, a - o) / slope;
  const Vector p = o + crossing.t * d;
  const Number area = dot(n, n);
  crossing.u = dot(n, cross(p - a, c - a)) / area;
  crossing.v = dot(n, cross(b - a, p - a)) / area;
  const Number w = 1 - crossing.u - crossing.v;
  if (crossing.u < 0 || crossing.v < 0 || w < 0) return {};
  crossing.meeting = crossing.u > 0 && crossing.v > 0 && w > 0 ? Meeting::interior : Meeting::boundary;
  return crossing;
}

/// Whether the triangle has a point in the closed box: what is left of it when each of the six half-spaces
/// has cut it (Sutherland & Hodgman 1974).
inline bool overlaps(const kerf::Triangle& triangle, const kerf::Box3f& box) {
  std::vector<Vector> polygon{vector(triangle.v0), vector(triangle.v1), vector(triangle.v2)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const Number plane =
          number(side < 0 ? box.lower[static_cast<int>(axis)] : box.upper[static_cast<int>(axis)]);
      const auto outside = [&](const Vector& p) { return Number(side * (p[axis] - plane)); };
      std::vector<Vector> rest;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const Number hp = outside(p), hq = outside(q);
        if (hp <= 0) rest.push_back(p);
        if ((hp < 0 && hq > 0) || (hp > 0 && hq < 0)) rest.push_back(p + Number(hp / (hp - hq)) * (q - p));
      }
      polygon = rest;
    }
  }
  return !polygon.empty();
}

/// The squared distance from a point to a triangle with an area: to the nearest point of its plane if that is
/// inside, else of its edges.
inline Number squared_distance(const kerf::Vec3f& point, const kerf::Triangle& triangle) {
  const Vector p = vector(point);
  const Vector corners[3] = {vector(triangle.v0), vector(triangle.v1), vector(triangle.v2)};
  const Vector n = cross(corners[1] - corners[0], corners[2] - corners[0]);
  bool inside = true;
  std::optional<Number> best;
  for (int i = 0; i < 3; ++i) {
    const Vector &a = corners[i], &b = corners[(i + 1) % 3];
    const Vector edge = b - a;
    inside = inside && dot(n, cross(edge, p - a)) >= 0;
    Number s = dot(p - a, edge) / dot(edge, edge);
    if (s < 0) s = 0;
    if (s > 1) s = 1;
    const Vector difference = p - (a + s * edge);
    const Number distance = dot(difference, difference);
    if (!best || distance < *best) best = distance;
  }
  if (!inside) return *best;
  const Number height = dot(n, p - corners[0]);
  return height * height / dot(n, n);
}

}  // namespace exact
