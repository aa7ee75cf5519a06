// What is asked of the layout, compiled once per instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <kerf/counters.hpp>
#include <kerf/query.hpp>
#include <kerf/ray.hpp>

#include "layout/wide_bvh.hpp"
#include "math/motion.hpp"
#include "traversal/boxes/box_pair.hpp"
#include "traversal/lines/crossing.hpp"
#include "traversal/points/near_triangle.hpp"

namespace kerf {

/// The kernels of one instruction set. Those of all instruction sets give the same results.
struct Kernels {
  const char* target;        ///< Highway's name of the instruction set
  std::size_t float_lanes;   ///< in one of its vectors
  std::uint32_t node_width;  ///< of the nodes that they trace

#define KERF_KERNEL(name, Result, parameters) Result(*name) parameters;
#include "traversal/kernels.def"
#undef KERF_KERNEL
};

/// Those of the target that `choose_target` gives.
const Kernels& choose_kernels();

}  // namespace kerf
