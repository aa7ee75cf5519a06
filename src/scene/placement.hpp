// Where an object stands in a scene: rays and points taken to its space, boxes taken from it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <kerf/query.hpp>
#include <kerf/ray.hpp>
#include <kerf/vec.hpp>

#include "math/box3f.hpp"
#include "math/ray_box.hpp"
#include "math/ray_crossing.hpp"
#include "simd/dispatch.hpp"

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
  /// What it consists of.
  struct Numbers {
    double inverse[3][3];
    double at[3];     // where c stands in the scene
    float center[3];  // c
    float stretch;
  };

  Placement() = default;
  explicit Placement(const Numbers& numbers) : numbers_(numbers) {}

  /// At least by how much the inverse map makes a distance longer at most, the largest singular value of
  /// M^-1, and no more than 1.04 times that.
  double largest_stretch() const { return numbers_.stretch; }

  /// By how much less `to_object(point)` may lie off the exact place, in the object.
  double rounding_of(const Vec3f& local) const {
    const double largest = std::max({std::abs(local.x), std::abs(local.y), std::abs(local.z)});
    return 0x1p-23 * largest +
           0x1p-40 * (double{std::abs(numbers_.center[0])} + std::abs(numbers_.center[1]) +
                      std::abs(numbers_.center[2])) +
           std::numeric_limits<float>::denorm_min();
  }

  Vec3f to_object(const Vec3f& point) const {
    const double q[3] = {point.x - numbers_.at[0], point.y - numbers_.at[1], point.z - numbers_.at[2]};
    Vec3f moved;
    for (int i = 0; i < 3; ++i)
      moved[i] = static_cast<float>(
          numbers_.center[i] +
          (numbers_.inverse[i][0] * q[0] + numbers_.inverse[i][1] * q[1] + numbers_.inverse[i][2] * q[2]));
    return moved;
  }

  /// The same ray, t for t, but for the rounding of its origin and of its direction.
  MovedRay to_object(const Ray& ray) const {
    const Vec3f& d = ray.direction;
    double direction[3];
    for (int i = 0; i < 3; ++i)
      direction[i] =
          numbers_.inverse[i][0] * d.x + numbers_.inverse[i][1] * d.y + numbers_.inverse[i][2] * d.z;
    return MovedRay(ray, to_object(ray.origin), direction);
  }

  /// The map that is `first`, from anywhere to the scene, followed by the way to the object's space.
  Transform to_object(const Transform& first) const {
    Transform map;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 4; ++j) {
        double& number = map.rows[i][j];
        number = j == 3 ? numbers_.center[i] : 0.0;
        for (int k = 0; k < 3; ++k)
          number += numbers_.inverse[i][k] * (j == 3 ? first.rows[k][3] - numbers_.at[k] : first.rows[k][j]);
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
      const double lower = double{bounds.lower[j]} - numbers_.center[j],
                   upper = double{bounds.upper[j]} - numbers_.center[j];
      size[j] = std::max(std::abs(lower), std::abs(upper));
    }
    double middle[3], half[3];  // of the box, from the place of c
    for (int i = 0; i < 3; ++i) {
      double sums = std::abs(m[i][3]);  // of what an image is the sum of
      double far_side = std::abs(numbers_.at[i]);
      for (int j = 0; j < 3; ++j) {
        sums += std::abs(m[i][j]) * (std::abs(numbers_.center[j]) + size[j]);
        far_side += std::abs(m[i][j]) * size[j];
      }
      const double lower = box.lower[i] - numbers_.at[i], upper = box.upper[i] - numbers_.at[i];
      const double margin = 0x1p-23 * far_side + 0x1p-48 * (sums + far_side) + 0x1p-50 * (upper - lower) +
                            std::numeric_limits<float>::denorm_min();
      middle[i] = 0.5 * (lower + upper);
      half[i] = 0.5 * (upper - lower) + margin;
    }
    Box3f local;
    for (int i = 0; i < 3; ++i) {
      double at = numbers_.center[i], reach = 0.0, sums = std::abs(numbers_.center[i]);
      for (int j = 0; j < 3; ++j) {
        at += numbers_.inverse[i][j] * middle[j];
        reach += std::abs(numbers_.inverse[i][j]) * half[j];
        sums += std::abs(numbers_.inverse[i][j]) * std::abs(middle[j]);
        double lacking = i == j ? 1.0 : 0.0, product = lacking;
        for (int k = 0; k < 3; ++k) {
          lacking -= numbers_.inverse[i][k] * m[k][j];
          product += std::abs(numbers_.inverse[i][k] * m[k][j]);
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
  Numbers numbers_;
};

/// An object at its place.
struct PlacedObject {
  Placement placement;

  /// The largest sum of a row of |M| |M^-1|, which is 1 where axes go to axes and at most 3 for a rotation;
  /// infinite if that is `max_condition` or more.
  double condition;

  static constexpr double max_condition = 0x1p20;
  bool is_invertible() const { return condition < max_condition; }
};

/// `bounds` are the object's, not empty.
PlacedObject place_object(const Transform& transform, const Box3f& bounds);

/// A box in the scene around the object. Any ray that, taken to the object's space, hits the object, meets it
/// where boxes are grown by the margin that `ray_margin` gives.
Box3f place_box(const Transform& transform, const Box3f& bounds);

/// The same for many at a time, to the bit.
struct PlacedBox {
  const Transform* transform;
  const Box3f* bounds;
};
void place_objects(Target target, std::span<const PlacedBox> placed, Placement* const* placements,
                   double* conditions);
void place_boxes(Target target, std::span<const PlacedBox> placed, Box3f* to);

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
