// The handle: copies share one structure.
#include <utility>

#include <kerf/bvh.hpp>

#include "base/fp_environment.hpp"
#include "structure.hpp"

namespace kerf {
namespace {

// What a hierarchy of nothing shares. It is a constant, so that handles are made and moved without memory.
Shared<Structure> nothing() noexcept {
  static const Structure structure;
  return SharedPointer<Structure>::share({std::shared_ptr<const void>(), &structure});
}

Vec3f rounded(const Vec3d& point, const Vec3d& origin) {
  return {static_cast<float>(point.x - origin.x), static_cast<float>(point.y - origin.y),
          static_cast<float>(point.z - origin.z)};
}

}  // namespace

template class Shared<Structure>;

Bvh::Bvh() noexcept : structure_(nothing()) {}
Bvh::Bvh(Shared<Structure> structure) noexcept : structure_(std::move(structure)) {}
Bvh::Bvh(Bvh&& other) noexcept : structure_(std::exchange(other.structure_, nothing())) {}
Bvh& Bvh::operator=(Bvh&& other) noexcept {
  structure_ = std::exchange(other.structure_, nothing());
  return *this;
}

Vec3d Bvh::origin() const {
  return structure_->origin;
}

Vec3f Bvh::to_local(const Vec3d& point) const {
  const PlainFloatingPoint plain;
  return rounded(point, structure_->origin);
}

Ray Bvh::to_local(const DoubleRay& ray) const {
  const PlainFloatingPoint plain;
  return {.origin = rounded(ray.origin, structure_->origin),
          .direction = rounded(ray.direction, {}),
          .t_min = static_cast<float>(ray.t_min),
          .t_max = static_cast<float>(ray.t_max)};
}

Vec3d Bvh::from_local(const Vec3f& point) const {
  const PlainFloatingPoint plain;
  const Vec3d& origin = structure_->origin;
  return {origin.x + point.x, origin.y + point.y, origin.z + point.z};
}

Box3f Bvh::bounds() const {
  return structure_->wide.bounds;
}

const BvhStatistics& Bvh::statistics() const {
  return structure_->statistics;
}

}  // namespace kerf
