// The traversals, compiled once for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <kerf/counters.hpp>
#include <kerf/ray.hpp>

#include "layout/wide_bvh.hpp"
#include "traversal/lines/prepared_line.hpp"
#include "traversal/points/near_triangle.hpp"

namespace kerf {

/// A good number of rays to give a thread at once: enough that the first and the last few in flight, which
/// have the core to themselves, do not count.
inline constexpr std::size_t rays_a_part = 1024;

/// All of them return the same hits; a hit's `primitive` is a triangle's number in the `Geometry`, its `mesh`
/// unset. The hierarchy must not be empty.
struct Kernels {
  const char* target;  ///< Highway's name of the instruction set

  void (*closest)(const WideBvh& bvh, const Ray& ray, Hit& hit);
  bool (*any)(const WideBvh& bvh, const Ray& ray);
  Hit (*closest_counted)(const WideBvh& bvh, const Ray& ray, TraversalCounters& counters);
  bool (*any_counted)(const WideBvh& bvh, const Ray& ray, TraversalCounters& counters);

  /// For many rays on one thread; misses are hits that convert to false.
  void (*closest_many)(const WideBvh& bvh, const Ray* rays, std::size_t count, Hit* hits);
  void (*any_many)(const WideBvh& bvh, const Ray* rays, std::size_t count, std::uint8_t* occluded);

  /// The triangle closest to `point`, if its squared distance is not above `reach`. `point` must be finite.
  bool (*closest_triangle)(const WideBvh& bvh, const Vec3f& point, double reach, NearTriangle& best);
  /// All references of triangles with squared distances not above `reach`, in any order.
  void (*triangles_within)(const WideBvh& bvh, const Vec3f& point, double reach,
                           std::vector<NearTriangle>& found);

  /// Calls `visit` for all references of triangles whose bounds have a point in `box`, until it returns
  /// false.
  void (*visit_box)(const WideBvh& bvh, const Box3f& box, void* visitor,
                    bool (*visit)(void* visitor, ChildLink leaf, std::uint32_t place));

  /// Bit i: the ray meets the box of child i, and enters it at `entry[i]` (Ize 2013, "Robust BVH Ray
  /// Traversal"): early by what rounding may take off a crossing in it, see `LineCrossing`, so that none
  /// seems to come before its box. Sixteen entries are written.
  std::uint32_t (*line_meets)(const WideNode& node, const PreparedLine& line, float* entry);
  /// Bit i: what double precision tells for certain does not rule out that the line crosses triangle i.
  std::uint32_t (*line_may_cross)(const WideBvh& bvh, ChildLink leaf, const PreparedLine& line);

  /// For measuring what a step of `closest` costs when nothing waits for memory: the root, or the leaf, is
  /// visited `count` times. Returns a number that means nothing.
  std::uint64_t (*repeat_node_steps)(const WideBvh& bvh, const Ray& ray, std::size_t count);
  std::uint64_t (*repeat_leaf_tests)(const WideBvh& bvh, const Ray& ray, ChildLink leaf, std::size_t count);
};

/// Those of the target that `choose_target` gives.
const Kernels& choose_kernels();

}  // namespace kerf
