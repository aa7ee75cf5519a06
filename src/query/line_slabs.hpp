// Where a ray enters a box, never later than it does (Ize 2013, "Robust BVH Ray Traversal"), in double
// precision.
#pragma once

#include <kerf/ray.hpp>

#include "math/predicates.hpp"

namespace kerf {

class LineSlabs {
 public:
  explicit LineSlabs(const Ray& ray)
      : origin_(ray.origin),
        inverse_{1.0 / ray.direction.x, 1.0 / ray.direction.y, 1.0 / ray.direction.z},
        t_min_(ray.t_min),
        t_max_(ray.t_max) {}

  /// Where the ray enters the box, early by what rounding may take off a crossing in it (`LineCrossing`), so
  /// that none seems to come before its box; infinity only if the ray misses.
  double entry(const Box3f& box) const {
    // A difference, a reciprocal and a product put a relative error of 3 * 2^-53 on each distance.
    constexpr double late = 1.0 + 8.0 / 9007199254740992.0, early = 1.0 - 0x1p-24;
    const Vec3d lower = difference(box.lower, origin_), upper = difference(box.upper, origin_);
    double enter = t_min_, leave = t_max_;
    // 0 * infinity, for a ray in the plane of a face, is not a number: the comparisons then leave the
    // interval alone.
    const auto clip = [&](double low, double high, double inverse) {
      const double near = (inverse < 0.0 ? high : low) * inverse * early;
      const double far = (inverse < 0.0 ? low : high) * inverse * late;
      if (near > enter) enter = near;
      if (far < leave) leave = far;
    };
    clip(lower.x, upper.x, inverse_.x);
    clip(lower.y, upper.y, inverse_.y);
    clip(lower.z, upper.z, inverse_.z);
    return enter <= leave ? enter : std::numeric_limits<double>::infinity();
  }

 private:
  Vec3f origin_;
  Vec3d inverse_;
  double t_min_, t_max_;
};

}  // namespace kerf
