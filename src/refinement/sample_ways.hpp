// What is known of the rays that a hierarchy is built for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <kerf/ray.hpp>

#include "tree/binary_tree.hpp"
#include "tree/geometry.hpp"

namespace kerf {

/// A few thousand rays say most; more of them only take time.
inline constexpr std::size_t max_sample_rays = std::size_t{1} << 18;

/// A copy of the rays, or of `max_sample_rays` of them that are evenly spread over their order.
std::vector<Ray> pick_samples(std::span<const Ray> rays);

/// The way of each ray that `pick_samples` gives to its closest hit: with that hit's t for its `t_max`.
/// Fewer, if they would take more than `max_work` tests of boxes and triangles: where all
/// triangles lie over one another, each ray tests all. Calls `progress`, which may be empty, with the
/// fraction that is done; throws `Error::cancelled` after a false. On all threads of the task arena that this
/// is called in.
std::vector<Ray> trace_to_hits(const BinaryTree& tree, const Geometry& geometry, std::span<const Ray> rays,
                               const std::function<bool(float)>& progress,
                               std::uint64_t max_work = std::uint64_t{1} << 26);

}  // namespace kerf
