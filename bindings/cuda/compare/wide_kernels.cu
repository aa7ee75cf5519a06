#include "../src/device_array.hpp"
#include "wide_kernels.hpp"
#include "wide_traversal.hpp"

namespace kerf::cuda {
namespace {

constexpr unsigned block = 128;
constexpr int min_blocks = 6;  // on a multiprocessor: 80 registers for each thread

__global__ void __launch_bounds__(block, min_blocks)
    trace_closest_wide(WideHierarchy hierarchy, MeshTable meshes, const Ray* rays, Hit* hits,
                       std::size_t count) {
  const std::size_t i = std::size_t{blockIdx.x} * block + threadIdx.x;
  if (i < count) hits[i] = trace_closest<WideTraversal>(hierarchy, meshes, rays + i);
}

__global__ void __launch_bounds__(block, min_blocks)
    trace_any_wide(WideHierarchy hierarchy, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const std::size_t i = std::size_t{blockIdx.x} * block + threadIdx.x;
  if (i < count) occluded[i] = trace_any<WideTraversal>(hierarchy, rays + i);
}

template <bool any_hit>
__global__ void __launch_bounds__(block)
    count_wide(WideHierarchy hierarchy, const Ray* rays, std::size_t count, TotalCounters* totals) {
  const std::size_t i = std::size_t{blockIdx.x} * block + threadIdx.x;
  if (i >= count) return;
  TracedRay traced;
  WideTraversal<any_hit, false, true> traversal;
  trace(hierarchy, rays + i, traced, traversal);
  atomicAdd(&totals->nodes, traversal.search.counters.nodes);
  atomicAdd(&totals->triangles, traversal.search.counters.triangles);
}

unsigned blocks_for(std::size_t rays) {
  return static_cast<unsigned>((rays + block - 1) / block);
}

}  // namespace

void launch_wide_closest(const WideHierarchy& hierarchy, const MeshTable& meshes, const Ray* rays, Hit* hits,
                         std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  trace_closest_wide<<<blocks_for(count), block, 0, stream>>>(hierarchy, meshes, rays, hits, count);
  check(cudaGetLastError(), "starting a traversal of a wide tree");
}
void launch_wide_any(const WideHierarchy& hierarchy, const Ray* rays, std::uint8_t* occluded,
                     std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  trace_any_wide<<<blocks_for(count), block, 0, stream>>>(hierarchy, rays, occluded, count);
  check(cudaGetLastError(), "starting a traversal of a wide tree");
}
void launch_wide_counted(const WideHierarchy& hierarchy, const Ray* rays, std::size_t count, bool any_hit,
                         TotalCounters* totals, cudaStream_t stream) {
  if (count == 0) return;
  const auto kernel = any_hit ? count_wide<true> : count_wide<false>;
  kernel<<<blocks_for(count), block, 0, stream>>>(hierarchy, rays, count, totals);
  check(cudaGetLastError(), "starting a counted traversal of a wide tree");
}

}  // namespace kerf::cuda
