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

const Kernels* kernels(std::size_t table_index) {
  static const Kernels kernels{.table_index = table_index,
                               .target = hwy::TargetName(HWY_TARGET),
                               .float_lanes = KERF_FLOAT_LANES,
                               .node_width = KERF_NODE_WIDTH};
  return &kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(kernels);

const Kernels& choose_kernels() {
  const Target target = choose_target();
  return *KERF_DISPATCH(kernels, target)(target.table_index);
}

}  // namespace kerf
#endif
