// An affine map applied to points and to boxes in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <kerf/query.hpp>
#include <kerf/triangle.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// Moves what lies within `bounds`. A point is computed in one order of operations and rounded to floats
/// once, so that a vertex moves the same way in each triangle that has it.
class Motion {
 public:
  Motion(const Transform& transform, const Box3f& bounds) : transform_(transform) {
    for (int i = 0; i < 3; ++i) {
      const double(&row)[4] = transform_.rows[i];
      double size = std::abs(row[3]);
      for (int j = 0; j < 3; ++j)
        size += std::abs(row[j]) * std::max(std::abs(bounds.lower[j]), std::abs(bounds.upper[j]));
      // A vertex is off by half a unit of a float, and by a few roundings of 2^-53 before.
      margin_[i] = 0x1p-23 * std::max(std::abs(end<false>(bounds, i)), std::abs(end<true>(bounds, i))) +
                   0x1p-49 * size + std::numeric_limits<float>::denorm_min();
    }
  }

  Vec3f operator()(const Vec3f& p) const {
    Vec3f moved;
    for (int i = 0; i < 3; ++i) {
      const double(&row)[4] = transform_.rows[i];
      moved[i] = static_cast<float>(row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3]);
    }
    return moved;
  }
  Triangle operator()(const Triangle& t) const { return {(*this)(t.v0), (*this)(t.v1), (*this)(t.v2)}; }

  /// A box that holds the points of moved triangles which come from points in `box`. Moved triangles have
  /// rounded corners, so that such a point may lie beside its own image.
  Box3f operator()(const Box3f& box) const {
    Box3f moved;
    for (int i = 0; i < 3; ++i) {
      constexpr float infinity = std::numeric_limits<float>::infinity();
      moved.lower[i] = std::nextafter(static_cast<float>(end<false>(box, i) - margin_[i]), -infinity);
      moved.upper[i] = std::nextafter(static_cast<float>(end<true>(box, i) + margin_[i]), infinity);
    }
    return moved;
  }

 private:
  // The smallest, or the largest, coordinate of the moved box on an axis.
  template <bool upper>
  double end(const Box3f& box, int i) const {
    const double(&row)[4] = transform_.rows[i];
    double sum = 0.0;
    for (int j = 0; j < 3; ++j) sum += row[j] * ((row[j] > 0.0) == upper ? box.upper[j] : box.lower[j]);
    return sum + row[3];
  }

  Transform transform_;
  double margin_[3];
};

}  // namespace kerf
