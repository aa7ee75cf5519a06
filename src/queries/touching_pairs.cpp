// Mesh against mesh.
#include <algorithm>
#include <cmath>

#include <kerf/bvh.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/raise.hpp"
#include "math/motion.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

// Exact arithmetic needs coordinates in its range.
Motion checked(const Transform& transform, const Box3f& bounds) {
  for (const auto& row : transform.rows)
    for (const double number : row)
      if (!std::isfinite(number)) raise(Error::invalid_argument, "a number of the transform is not finite");
  const Motion motion(transform, bounds);
  const Box3f moved = motion(bounds);
  for (int axis = 0; axis < 3; ++axis)
    if (!(moved.lower[axis] > -0x1p126f && moved.upper[axis] < 0x1p126f))
      raise(Error::invalid_argument, "the transform moves a mesh to coordinates of 2^126 and more");
  return motion;
}

// Calls `visit(first, second)` for pairs of triangles by number, perhaps more than once, until it returns
// false.
template <class Visit>
void visit_pairs(const Structure& first, const Structure& second, const Transform& transform, Visit&& visit) {
  if (first.wide.empty() || second.wide.empty()) return;
  first.kernels->visit_pairs(first.wide, second.wide, checked(transform, second.wide.bounds), &visit,
                             [](void* visitor, std::uint32_t a, std::uint32_t b) {
                               return (*static_cast<std::remove_reference_t<Visit>*>(visitor))(a, b);
                             });
}

}  // namespace

bool Bvh::touches(const Bvh& other, const Transform& transform) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    bool found = false;
    visit_pairs(*structure_, *other.structure_, transform, [&](std::uint32_t, std::uint32_t) {
      found = true;
      return false;
    });
    return found;
  });
}

std::vector<TouchingPair> Bvh::touching_pairs(const Bvh& other, const Transform& transform) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    std::vector<std::uint64_t> found;
    visit_pairs(*structure_, *other.structure_, transform, [&](std::uint32_t a, std::uint32_t b) {
      found.push_back(std::uint64_t{a} << 32 | b);
      return true;
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::vector<TouchingPair> pairs;
    pairs.reserve(found.size());
    for (const std::uint64_t pair : found)
      pairs.push_back({locate(*structure_, static_cast<std::uint32_t>(pair >> 32)),
                       locate(*other.structure_, static_cast<std::uint32_t>(pair))});
    return pairs;
  });
}

}  // namespace kerf
