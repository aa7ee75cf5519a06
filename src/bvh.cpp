// The handle: copies share one structure.
#include <utility>

#include <kerf/bvh.hpp>

#include "structure.hpp"

namespace kerf {
namespace {

// What a hierarchy of nothing shares. It is a constant, so that handles are made and moved without memory.
std::shared_ptr<const Structure> nothing() noexcept {
  static const Structure structure;
  return {std::shared_ptr<const void>(), &structure};
}

}  // namespace

Bvh::Bvh() noexcept : structure_(nothing()) {}
Bvh::Bvh(std::shared_ptr<const Structure> structure) noexcept : structure_(std::move(structure)) {}
Bvh::Bvh(Bvh&& other) noexcept : structure_(std::exchange(other.structure_, nothing())) {}
Bvh& Bvh::operator=(Bvh&& other) noexcept {
  structure_ = std::exchange(other.structure_, nothing());
  return *this;
}

Box3f Bvh::bounds() const {
  return structure_->wide.bounds;
}

const BvhStatistics& Bvh::statistics() const {
  return structure_->statistics;
}

}  // namespace kerf
