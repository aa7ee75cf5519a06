// The shapes that generated scenes are composed of.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <kerf/vec.hpp>

#include "workbench/base/vectors.hpp"

namespace workbench {

/// A point of a surface of revolution: its distance from the axis, and its height above the foot of the axis.
struct ProfilePoint {
  float radius;
  float height;
};

/// Collects triangles. The triangles of one shape share vertices and face outward.
class MeshMaker {
 public:
  std::uint32_t add_vertex(const Vec3f& p) {
    vertices_.push_back(p);
    return static_cast<std::uint32_t>(vertices_.size() - 1);
  }
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles_.push_back({a, b, c}); }
  void add_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const std::uint32_t first = add_vertex(a);
    add_vertex(b);
    add_vertex(c);
    add_triangle(first, first + 1, first + 2);
  }

  /// A flat quadrilateral of two triangles; corners counter-clockwise.
  void add_quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d);

  /// `columns` by `rows` squares of two triangles each over `surface(u, v)`, u and v from 0 to 1.
  template <class Surface>
  void add_grid(std::uint32_t columns, std::uint32_t rows, Surface&& surface) {
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (std::uint32_t row = 0; row <= rows; ++row) {
      const float v = static_cast<float>(row) / static_cast<float>(rows);
      for (std::uint32_t column = 0; column <= columns; ++column) {
        add_vertex(surface(static_cast<float>(column) / static_cast<float>(columns), v));
      }
    }
    for (std::uint32_t row = 0; row < rows; ++row) {
      for (std::uint32_t column = 0; column < columns; ++column) {
        const std::uint32_t a = first + row * (columns + 1) + column, b = a + 1, c = b + columns + 1,
                            d = c - 1;
        add_triangle(a, b, c);
        add_triangle(a, c, d);
      }
    }
  }

  /// The box spanned by three edges from `corner`: twelve triangles.
  void add_box(const Vec3f& corner, const Vec3f& x, const Vec3f& y, const Vec3f& z);

  /// The axis-aligned box between two corners: twelve triangles.
  void add_box(const Vec3f& lower, const Vec3f& upper);

  /// The surface of revolution of a profile, listed upward, about the vertical through `foot`.
  void add_lathe(const Vec3f& foot, std::span<const ProfilePoint> profile, std::uint32_t segments);

  /// A round tube along a path of two points or more. Its radius is `radius(t)`, where t goes from 0 at the
  /// first point in equal steps to 1 at the last. It is open at its ends: 2 * sides triangles between two
  /// points.
  template <class Radius>
  void add_tube(std::span<const Vec3f> path, std::uint32_t sides, Radius&& radius) {
    Vec3f side = any_normal(path[1] - path[0]);
    std::uint32_t ring = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Vec3f along = normalize(path[std::min(i + 1, path.size() - 1)] - path[i == 0 ? 0 : i - 1]);
      side = normalize(side - dot(side, along) * along);  // transported along the path without twist
      const std::uint32_t previous = ring;
      ring = add_ring(path[i], side, cross(along, side), sides,
                      radius(static_cast<float>(i) / static_cast<float>(path.size() - 1)));
      if (i > 0) join_rings(previous, ring, sides);
    }
  }

  /// A straight round bar, open at its ends.
  void add_bar(const Vec3f& from, const Vec3f& to, float radius, std::uint32_t sides);

  std::size_t triangle_count() const { return triangles_.size(); }
  std::vector<Vec3f>& vertices() { return vertices_; }
  std::vector<std::array<std::uint32_t, 3>>& triangles() { return triangles_; }

 private:
  static Vec3f any_normal(const Vec3f& direction);
  std::uint32_t add_ring(const Vec3f& center, const Vec3f& x, const Vec3f& y, std::uint32_t sides,
                         float radius);
  void join_rings(std::uint32_t lower, std::uint32_t upper, std::uint32_t sides);

  std::vector<Vec3f> vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

/// `count` times `factor`, rounded, and not below `min`.
std::uint32_t scaled(double count, double factor, std::uint32_t min);

}  // namespace workbench
