// Inside a closed surface, on it, or outside; and how far from it.
#include <cmath>
#include <limits>

#include <kerf/bvh.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "math/box3f.hpp"
#include "queries/batches.hpp"
#include "queries/points.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

Side side_of(const Structure& structure, const Vec3f& point) {
  if (!contains(structure.wide.bounds, Box3f{point, point})) return Side::outside;
  return structure.kernels->side_of(structure.wide, point);
}

float signed_distance_of(const Structure& structure, const Vec3f& point) {
  const SurfacePoint closest = closest_point(structure, point, std::numeric_limits<float>::infinity());
  if (!closest) return std::numeric_limits<float>::infinity();
  return side_of(structure, point) == Side::outside ? closest.distance : -closest.distance;
}

}  // namespace

Side Bvh::side(const Vec3f& point) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] { return side_of(*structure_, point); });
}

void Bvh::side(const PointView& points, std::span<Side> sides, const BatchOptions& options) const {
  require_as_many(points.size(), sides.size(), "as many sides as points are needed");
  for_each_point(points, options,
                 [&](std::size_t i, const Vec3f& point) { sides[i] = side_of(*structure_, point); });
}

bool Bvh::contains(const Vec3f& point) const {
  return side(point) != Side::outside;
}

void Bvh::contains(const PointView& points, const FlagView& inside, const BatchOptions& options) const {
  require_as_many(points.size(), inside.size(), "as many results as points are needed");
  for_each_point(points, options, [&](std::size_t i, const Vec3f& point) {
    inside.set(i, side_of(*structure_, point) != Side::outside);
  });
}

float Bvh::signed_distance(const Vec3f& point) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] { return signed_distance_of(*structure_, point); });
}

void Bvh::signed_distance(const PointView& points, std::span<float> distances,
                          const BatchOptions& options) const {
  require_as_many(points.size(), distances.size(), "as many distances as points are needed");
  for_each_point(points, options, [&](std::size_t i, const Vec3f& point) {
    distances[i] = signed_distance_of(*structure_, point);
  });
}

}  // namespace kerf
