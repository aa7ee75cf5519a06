// Where an object stands in a scene: rays and points taken to its space, boxes taken from it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <kerf/query.hpp>
#include <kerf/ray.hpp>
#include <kerf/vec.hpp>

#include "math/box3f.hpp"
#include "math/ray_box.hpp"
#include "math/ray_crossing.hpp"

namespace kerf {

/// An affine map M x + T from an object to a scene, and its inverse. The inverse is applied around a point c
/// of the object, which stands at M c + T in the scene:
///
///     x' = c + M^-1 (x - (M c + T))
///
/// so that little is lost to cancellation where an object is far from its own origin or from the scene's.
/// A ray in the space of an object.
struct MovedRay {
  Ray ray;
  double unit = 1.0;  ///< by which a t of it is multiplied to one in the scene: a power of two

  /// A ray that has not been moved.
  explicit MovedRay(const Ray& scene_ray) : ray(scene_ray) {}

  MovedRay(const Ray& scene_ray, const Vec3f& origin, const double (&direction)[3])
      : ray{.origin = origin, .direction = {}, .t_min = scene_ray.t_min, .t_max = scene_ray.t_max} {
    // Above, and above 0, the digits of a float are all there.
    constexpr double largest = 0x1p100, smallest = 0x1p-100;
    const double length = std::max({std::abs(direction[0]), std::abs(direction[1]), std::abs(direction[2])});
    double scale = 1.0;
    if (!(length > smallest && length < largest) && length > 0.0 && std::isfinite(length)) {
      scale = std::ldexp(1.0, -std::ilogb(length));
      unit = scale;
      ray.t_min = in_object(scene_ray.t_min);
      ray.t_max = in_object(scene_ray.t_max);
    }
    for (int i = 0; i < 3; ++i) ray.direction[i] = static_cast<float>(direction[i] * scale);
  }

  float in_object(float t) const {
    constexpr double limit = std::numeric_limits<float>::max();
    return unit == 1.0 || std::isinf(t) ? t : static_cast<float>(std::clamp(t / unit, -limit, limit));
  }
  float in_scene(float t) const { return unit == 1.0 ? t : round_distance(t * unit); }
};

class Placement {
 public:
  /// `bounds` are the object's, not empty. Check `condition` before use.
  Placement(const Transform& transform, const Box3f& bounds) {
    const auto& m = transform.rows;
    for (int j = 0; j < 3; ++j) {
      const double lower = bounds.lower[j], upper = bounds.upper[j];
      center_[j] = std::abs(lower) + std::abs(upper) > 4.0 * (upper - lower) ? bounds.lower[j] : 0.0f;
    }
    invert(m);
    for (int i = 0; i < 3; ++i)
      at_[i] = m[i][0] * center_.x + m[i][1] * center_.y + m[i][2] * center_.z + m[i][3];
  }

  static constexpr double max_condition = 0x1p20;

  /// The largest sum of a row of |M| |M^-1|, which is 1 where axes go to axes and at most 3 for a rotation;
  /// infinite if that is `max_condition` or more. `transform` is the one that this was made of.
  double condition(const Transform& transform) const {
    double largest = 0.0;
    for (const auto& row : transform.rows) {
      double sum = 0.0;
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) sum += std::abs(row[k] * inverse_[k][j]);
      if (!(sum < max_condition)) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, sum);
    }
    return largest;
  }

  /// A box in the scene around the object. Any ray that, taken to the object's space, hits the object, meets
  /// it where boxes are grown by the margin that `ray_margin` gives. The arguments are those that this was
  /// made of.
  Box3f box(const Transform& transform, const Box3f& bounds) const {
    Box3f box;
    for (int i = 0; i < 3; ++i) {
      const double(&row)[4] = transform.rows[i];
      double low = at_[i], high = at_[i], size = 0.0;
      for (int j = 0; j < 3; ++j) {
        const double lower = double{bounds.lower[j]} - center_[j],
                     upper = double{bounds.upper[j]} - center_[j];
        const double a = row[j] * lower, b = row[j] * upper;
        low += std::min(a, b);
        high += std::max(a, b);
        size += std::abs(row[j]) * (std::abs(center_[j]) + std::max(std::abs(lower), std::abs(upper)));
      }
      // The last two are for the rounding here, to a float at last.
      const double margin = 0x1p-16 * size + 0x1p-46 * (std::abs(row[3]) + size) +
                            0x1p-23 * std::max(std::abs(low), std::abs(high)) +
                            std::numeric_limits<float>::min();
      box.lower[i] = static_cast<float>(low - margin);
      box.upper[i] = static_cast<float>(high + margin);
    }
    return box;
  }

  /// At least by how much the inverse map makes a distance longer at most, the largest singular value of
  /// M^-1, and no more than 1.04 times that.
  double largest_stretch() const { return stretch_; }

  /// By how much less `to_object(point)` may lie off the exact place, in the object.
  double rounding_of(const Vec3f& local) const {
    const double largest = std::max({std::abs(local.x), std::abs(local.y), std::abs(local.z)});
    return 0x1p-23 * largest +
           0x1p-40 * (double{std::abs(center_.x)} + std::abs(center_.y) + std::abs(center_.z)) +
           std::numeric_limits<float>::denorm_min();
  }

  Vec3f to_object(const Vec3f& point) const {
    const double q[3] = {point.x - at_[0], point.y - at_[1], point.z - at_[2]};
    Vec3f moved;
    for (int i = 0; i < 3; ++i)
      moved[i] = static_cast<float>(center_[i] +
                                    (inverse_[i][0] * q[0] + inverse_[i][1] * q[1] + inverse_[i][2] * q[2]));
    return moved;
  }

  /// The same ray, t for t, but for the rounding of its origin and of its direction.
  MovedRay to_object(const Ray& ray) const {
    const Vec3f& d = ray.direction;
    double direction[3];
    for (int i = 0; i < 3; ++i)
      direction[i] = inverse_[i][0] * d.x + inverse_[i][1] * d.y + inverse_[i][2] * d.z;
    return MovedRay(ray, to_object(ray.origin), direction);
  }

  /// The map that is `first`, from anywhere to the scene, followed by the way to the object's space.
  Transform to_object(const Transform& first) const {
    Transform map;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 4; ++j) {
        double& number = map.rows[i][j];
        number = j == 3 ? center_[i] : 0.0;
        for (int k = 0; k < 3; ++k)
          number += inverse_[i][k] * (j == 3 ? first.rows[k][3] - at_[k] : first.rows[k][j]);
      }
    }
    return map;
  }

  /// A box around all points of the object whose images in the scene, computed in double precision and
  /// perhaps rounded to floats, lie in `box`; empty if there are none. `transform` and `bounds` are those
  /// that this was made of.
  ///
  /// With any matrix A, and exactly, x = A M x + (I - A M) x: what the inverse A lacks is bounded by I - A M.
  Box3f to_object(const Box3f& box, const Transform& transform, const Box3f& bounds) const {
    const auto& m = transform.rows;
    double size[3];  // of the object, around c
    for (int j = 0; j < 3; ++j) {
      const double lower = double{bounds.lower[j]} - center_[j], upper = double{bounds.upper[j]} - center_[j];
      size[j] = std::max(std::abs(lower), std::abs(upper));
    }
    double middle[3], half[3];  // of the box, from the place of c
    for (int i = 0; i < 3; ++i) {
      double sums = std::abs(m[i][3]);  // of what an image is the sum of
      double far_side = std::abs(at_[i]);
      for (int j = 0; j < 3; ++j) {
        sums += std::abs(m[i][j]) * (std::abs(center_[j]) + size[j]);
        far_side += std::abs(m[i][j]) * size[j];
      }
      const double lower = box.lower[i] - at_[i], upper = box.upper[i] - at_[i];
      const double margin = 0x1p-23 * far_side + 0x1p-48 * (sums + far_side) + 0x1p-50 * (upper - lower) +
                            std::numeric_limits<float>::denorm_min();
      middle[i] = 0.5 * (lower + upper);
      half[i] = 0.5 * (upper - lower) + margin;
    }
    Box3f local;
    for (int i = 0; i < 3; ++i) {
      double at = center_[i], reach = 0.0, sums = std::abs(center_[i]);
      for (int j = 0; j < 3; ++j) {
        at += inverse_[i][j] * middle[j];
        reach += std::abs(inverse_[i][j]) * half[j];
        sums += std::abs(inverse_[i][j]) * std::abs(middle[j]);
        double lacking = i == j ? 1.0 : 0.0, product = lacking;
        for (int k = 0; k < 3; ++k) {
          lacking -= inverse_[i][k] * m[k][j];
          product += std::abs(inverse_[i][k] * m[k][j]);
        }
        reach += (std::abs(lacking) + 0x1p-49 * product) * size[j];
      }
      reach = reach * (1.0 + 0x1p-40) + 0x1p-48 * sums;
      const double edge = 0x1p-23 * (std::abs(at) + reach) + std::numeric_limits<float>::denorm_min();
      local.lower[i] = static_cast<float>(at - reach - edge);
      local.upper[i] = static_cast<float>(at + reach + edge);
    }
    return intersect(local, bounds);
  }

 private:
  void invert(const double (&m)[3][4]) {
    const auto minor = [&](int i, int j) {  // with its sign
      const int r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      return m[r][c] * m[s][d] - m[r][d] * m[s][c];
    };
    const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) inverse_[i][j] = minor(j, i) / determinant;
    stretch_ = static_cast<float>(largest_singular_value(inverse_));
  }

  // S = A A^T has the square of it as its largest eigenvalue, and S^8 the sixteenth power. The largest sum of
  // a row of a symmetric matrix is at least that of the eigenvalues, and at most the square root of 3 times
  // that: 3^(1/32) = 1.035.
  static double largest_singular_value(const double (&a)[3][3]) {
    double s[3][3], trace = 0.0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) s[i][j] = a[i][0] * a[j][0] + a[i][1] * a[j][1] + a[i][2] * a[j][2];
      trace += s[i][i];
    }
    for (auto& row : s)
      for (double& x : row) x /= trace;  // the largest eigenvalue is one in [1/3, 1] now
    for (int squaring = 0; squaring < 3; ++squaring) {
      double squared[3][3];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) squared[i][j] = s[i][0] * s[0][j] + s[i][1] * s[1][j] + s[i][2] * s[2][j];
      std::copy(&squared[0][0], &squared[0][0] + 9, &s[0][0]);
    }
    double largest = 0.0;
    for (const auto& row : s)
      largest = std::max(largest, std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
    return std::sqrt(trace * std::sqrt(std::sqrt(std::sqrt(largest)))) * (1.0 + 1e-6);
  }

  double inverse_[3][3], at_[3];
  Vec3f center_;
  float stretch_ = 0.0f;
};

/// By how much less than this kernels report a hit beside the box of an object, see `RayBoxes`, in units of
/// 2^-24 of the distance D from the ray's origin to the far side of the scene.
inline constexpr double object_margin = RayBoxes::margin_of_distance + RayBoxes::margin_of_origin;

/// By how much boxes in a scene have to be grown so that no place with this condition is missed, where what
/// stands there may be hit beside its box by `margin_inside`. That margin is one of a distance of up to D
/// times |M^-1| in the object's space, and |M| times that in the scene. The rounding of origin and direction
/// adds 2 units each. What grows with the object and not with D is in `Placement::box`.
inline double ray_margin(double condition, double margin_inside) {
  return (margin_inside + 12.0) * condition;
}

}  // namespace kerf
