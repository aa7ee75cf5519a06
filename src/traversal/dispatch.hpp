// What is asked of the layout, compiled once per instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
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

// The versions of each kernel. The file of a kernel defines them, by KERF_EXPORT_KERNEL, and nothing but a
// call of the kernel names them: a program is linked with the kernels that it can reach.
#define KERF_KERNEL(name, Result, parameters) extern Result(*const name##_versions[]) parameters;
#include "traversal/kernels.def"
#undef KERF_KERNEL

/// The kernels of one instruction set. Those of all instruction sets give the same results.
struct Kernels {
  std::size_t table_index;   ///< see `Target`
  const char* target;        ///< Highway's name of the instruction set
  std::size_t float_lanes;   ///< in one of its vectors
  std::uint32_t node_width;  ///< of the nodes that they trace

#define KERF_KERNEL(name, Result, parameters)                                   \
  template <class... Arguments>                                                 \
  Result name(Arguments&&... arguments) const {                                 \
    return name##_versions[table_index](std::forward<Arguments>(arguments)...); \
  }
#include "traversal/kernels.def"
#undef KERF_KERNEL
};

/// Those of the target that `choose_target` gives.
const Kernels& choose_kernels();

/// Below `#if HWY_ONCE`, in the file of the kernel.
#define KERF_EXPORT_KERNEL(name) \
  decltype(&HWY_STATIC_DISPATCH(name)) const name##_versions[] = KERF_VERSIONS(name)

}  // namespace kerf
