#include "device_array.hpp"
#include "launch.hpp"

namespace kerf::cuda {
namespace {

constexpr unsigned block = 128;
constexpr int min_blocks = 9;  // on a multiprocessor: 56 registers for each thread

__global__ void __launch_bounds__(block, min_blocks)
    trace_closest_hits(BinaryHierarchy hierarchy, MeshTable meshes, const Ray* rays, Hit* hits,
                       std::size_t count) {
  const std::size_t i = std::size_t{blockIdx.x} * block + threadIdx.x;
  if (i < count) hits[i] = trace_closest(hierarchy, meshes, rays + i);
}

__global__ void __launch_bounds__(block, min_blocks)
    trace_any_hits(BinaryHierarchy hierarchy, const Ray* rays, std::uint8_t* occluded, std::size_t count) {
  const std::size_t i = std::size_t{blockIdx.x} * block + threadIdx.x;
  if (i < count) occluded[i] = trace_any(hierarchy, rays + i);
}

template <bool any_hit>
__global__ void __launch_bounds__(block)
    trace_counting(BinaryHierarchy hierarchy, const Ray* rays, std::size_t count, TotalCounters* totals) {
  const std::size_t i = std::size_t{blockIdx.x} * block + threadIdx.x;
  if (i >= count) return;
  TracedRay traced;
  BinaryTraversal<any_hit, false, true> traversal;
  trace(hierarchy, rays + i, traced, traversal);
  atomicAdd(&totals->nodes, traversal.search.counters.nodes);
  atomicAdd(&totals->triangles, traversal.search.counters.triangles);
}

unsigned blocks_for(std::size_t rays) {
  return static_cast<unsigned>((rays + block - 1) / block);
}

}  // namespace

void launch_closest(const BinaryHierarchy& hierarchy, const MeshTable& meshes, const Ray* rays, Hit* hits,
                    std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  trace_closest_hits<<<blocks_for(count), block, 0, stream>>>(hierarchy, meshes, rays, hits, count);
  check(cudaGetLastError(), "starting a traversal");
}
void launch_any(const BinaryHierarchy& hierarchy, const Ray* rays, std::uint8_t* occluded, std::size_t count,
                cudaStream_t stream) {
  if (count == 0) return;
  trace_any_hits<<<blocks_for(count), block, 0, stream>>>(hierarchy, rays, occluded, count);
  check(cudaGetLastError(), "starting a traversal");
}
void launch_counted(const BinaryHierarchy& hierarchy, const Ray* rays, std::size_t count, bool any_hit,
                    TotalCounters* totals, cudaStream_t stream) {
  if (count == 0) return;
  const auto kernel = any_hit ? trace_counting<true> : trace_counting<false>;
  kernel<<<blocks_for(count), block, 0, stream>>>(hierarchy, rays, count, totals);
  check(cudaGetLastError(), "starting a counted traversal");
}

}  // namespace kerf::cuda
