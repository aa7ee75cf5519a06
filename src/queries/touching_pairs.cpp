// Mesh against mesh.
#include <algorithm>

#include <kerf/bvh.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "math/motion.hpp"
#include "queries/batches.hpp"
#include "queries/pairs.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
bool Bvh::touches(const Bvh& other, const Transform& transform) const {
  const PlainFloatingPoint plain;
  const WideBvh &first = structure_->wide, &second = other.structure_->wide;
  if (first.empty() || second.empty()) return false;
  return report_out_of_memory([&] {
    const Motion motion = checked_motion(transform, second.bounds);
    bool found = false;
    visit_pairs(*structure_->kernels, first, second, motion, root_pair(first, second, motion),
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
    const Motion motion = checked_motion(transform, second.bounds);
    // Enough that threads which are done early find more to do.
    constexpr std::size_t wanted_parts = 512;
    const std::vector<BoxPair> starts =
        kernels.open_pairs(first, second, motion, root_pair(first, second, motion), wanted_parts);
    std::vector<std::vector<std::uint64_t>> parts(starts.size());
    for_each_batch(starts.size(), 1, options, [&](std::size_t part, std::size_t) {
      visit_pairs(kernels, first, second, motion, starts[part], [&](std::uint32_t a, std::uint32_t b) {
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
