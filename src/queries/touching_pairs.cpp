// Mesh against mesh.
#include <algorithm>
#include <cmath>

#include <kerf/bvh.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/raise.hpp"
#include "math/motion.hpp"
#include "queries/batches.hpp"
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

BoxPair roots(const WideBvh& first, const WideBvh& second, const Motion& motion) {
  return {ChildLink::node(0), ChildLink::node(0), first.bounds, motion(second.bounds)};
}

// Calls `visit(first, second)` for pairs of triangles below `start`, by number, perhaps more than once, until
// it returns false.
template <class Visit>
void visit_pairs(const WideBvh& first, const WideBvh& second, const Kernels& kernels, const Motion& motion,
                 const BoxPair& start, Visit&& visit) {
  kernels.visit_pairs(first, second, motion, start, &visit,
                      [](void* visitor, std::uint32_t a, std::uint32_t b) {
                        return (*static_cast<std::remove_reference_t<Visit>*>(visitor))(a, b);
                      });
}

}  // namespace

bool Bvh::touches(const Bvh& other, const Transform& transform) const {
  const PlainFloatingPoint plain;
  const WideBvh &first = structure_->wide, &second = other.structure_->wide;
  if (first.empty() || second.empty()) return false;
  return report_out_of_memory([&] {
    const Motion motion = checked(transform, second.bounds);
    bool found = false;
    visit_pairs(first, second, *structure_->kernels, motion, roots(first, second, motion),
                [&](std::uint32_t, std::uint32_t) {
                  found = true;
                  return false;
                });
    return found;
  });
}

std::vector<TouchingPair> Bvh::touching_pairs(const Bvh& other, const Transform& transform,
                                              const BatchOptions& options) const {
  const WideBvh &first = structure_->wide, &second = other.structure_->wide;
  if (first.empty() || second.empty()) return {};
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    const Kernels& kernels = *structure_->kernels;
    const Motion motion = checked(transform, second.bounds);
    // Enough that threads which are done early find more to do.
    constexpr std::size_t wanted_parts = 512;
    const std::vector<BoxPair> starts =
        kernels.open_pairs(first, second, motion, roots(first, second, motion), wanted_parts);
    std::vector<std::vector<std::uint64_t>> parts(starts.size());
    for_each_batch(starts.size(), 1, options, [&](std::size_t part, std::size_t) {
      visit_pairs(first, second, kernels, motion, starts[part], [&](std::uint32_t a, std::uint32_t b) {
        parts[part].push_back(std::uint64_t{a} << 32 | b);
        return true;
      });
    });
    std::vector<std::uint64_t> found;
    for (const std::vector<std::uint64_t>& part : parts) found.insert(found.end(), part.begin(), part.end());
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
