#include <cub/device/device_scan.cuh>
#include <cuda_runtime_api.h>
#include <kerf/cuda/gather.hpp>

#include "device_array.hpp"

namespace kerf::cuda {
namespace {

constexpr unsigned block = 128;

__device__ float number(const Column<const float>& column, std::size_t i, float otherwise) {
  if (column.data == nullptr) return otherwise;
  return *reinterpret_cast<const float*>(reinterpret_cast<const char*>(column.data) +
                                         static_cast<std::ptrdiff_t>(i) * column.stride);
}

__global__ void __launch_bounds__(block) gather(RayView columns, Ray otherwise, Ray* rays) {
  const std::size_t i = std::size_t{blockIdx.x} * block + threadIdx.x;
  if (i >= columns.count) return;
  Ray& ray = rays[i];
  ray.origin.x = number(columns.origin[0], i, otherwise.origin.x);
  ray.origin.y = number(columns.origin[1], i, otherwise.origin.y);
  ray.origin.z = number(columns.origin[2], i, otherwise.origin.z);
  ray.direction.x = number(columns.direction[0], i, otherwise.direction.x);
  ray.direction.y = number(columns.direction[1], i, otherwise.direction.y);
  ray.direction.z = number(columns.direction[2], i, otherwise.direction.z);
  ray.t_min = number(columns.t_min, i, otherwise.t_min);
  ray.t_max = number(columns.t_max, i, otherwise.t_max);
}

// The counts with a zero behind them, in the width of their sums.
__global__ void __launch_bounds__(block)
    widen(const std::uint32_t* counts, std::uint64_t* offsets, std::size_t count) {
  const std::size_t i = std::size_t{blockIdx.x} * block + threadIdx.x;
  if (i <= count) offsets[i] = i < count ? counts[i] : 0;
}

unsigned blocks_for(std::size_t count) {
  return static_cast<unsigned>((count + block - 1) / block);
}

}  // namespace

void gather_rays(const RayView& columns, const Ray& otherwise, Ray* rays, Stream stream) {
  if (columns.count == 0) return;
  gather<<<blocks_for(columns.count), block, 0, stream>>>(columns, otherwise, rays);
  check(cudaGetLastError(), "starting to gather rays");
}

void sum_counts(const std::uint32_t* counts, std::uint64_t* offsets, std::size_t count, Stream stream) {
  widen<<<blocks_for(count + 1), block, 0, stream>>>(counts, offsets, count);
  check(cudaGetLastError(), "starting to sum counts");
  const auto scan = [&](void* memory, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(memory, bytes, offsets, offsets,
                                         static_cast<std::int64_t>(count) + 1, stream);
  };
  std::size_t bytes = 0;
  check(scan(nullptr, bytes), "asking what summing needs");
  void* memory = nullptr;
  check(cudaMallocAsync(&memory, bytes, stream), "taking memory of the device");
  const cudaError_t result = scan(memory, bytes);
  cudaFreeAsync(memory, stream);
  check(result, "summing counts");
}

}  // namespace kerf::cuda
