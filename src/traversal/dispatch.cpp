#include "traversal/dispatch.hpp"

#include "simd/dispatch.hpp"
#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "traversal/dispatch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

#define KERF_KERNEL(name, Result, parameters) Result name parameters;
#include "traversal/kernels.def"
#undef KERF_KERNEL

const Kernels* kernels() {
#define KERF_KERNEL(name, Result, parameters) .name = name,
  static const Kernels table{
      .target = hwy::TargetName(HWY_TARGET),
      .float_lanes = KERF_FLOAT_LANES,
      .node_width = KERF_NODE_WIDTH,
#include "traversal/kernels.def"
  };
#undef KERF_KERNEL
  return &table;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(kernels);

const Kernels& choose_kernels() {
  return *KERF_DISPATCH(kernels, choose_target())();
}

}  // namespace kerf
#endif
