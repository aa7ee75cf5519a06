#include "closest_point.hpp"
#include "crossings.hpp"
#include "device_array.hpp"
#include "launch.hpp"
#include "list_hits.hpp"

namespace kerf::cuda {
namespace {

template <class Query>
__global__ void __launch_bounds__(128) answer(std::size_t count, Query query) {
  const std::size_t i = std::size_t{blockIdx.x} * 128 + threadIdx.x;
  if (i < count) query(i);
}
template <class Query>
void launch(std::size_t count, const Query& query, cudaStream_t stream) {
  if (count == 0) return;
  answer<<<static_cast<unsigned>((count + 127) / 128), 128, 0, stream>>>(count, query);
  check(cudaGetLastError(), "starting a query");
}

}  // namespace

void launch_count_hits(const BinaryHierarchy& hierarchy, const Ray* rays, std::uint32_t* counts,
                       std::size_t count, cudaStream_t stream) {
  launch(
      count, [=] __device__(std::size_t i) { counts[i] = count_crossings(hierarchy, rays[i]); }, stream);
}
void launch_list_hits(const BinaryHierarchy& hierarchy, const MeshTable& meshes, const Ray* rays,
                      const std::uint64_t* offsets, Hit* hits, std::size_t count, cudaStream_t stream) {
  launch(
      count,
      [=] __device__(std::size_t i) {
        list_crossings(hierarchy, meshes, rays[i], hits + offsets[i], offsets[i + 1] - offsets[i]);
      },
      stream);
}
void launch_contains(const BinaryHierarchy& hierarchy, const Vec3f* points, std::uint8_t* inside,
                     std::size_t count, cudaStream_t stream) {
  launch(
      count, [=] __device__(std::size_t i) { inside[i] = contains(hierarchy, points[i]); }, stream);
}
void launch_closest_point(const BinaryHierarchy& hierarchy, const MeshTable& meshes, const Vec3f* points,
                          SurfacePoint* closest, std::size_t count, float max_distance, cudaStream_t stream) {
  launch(
      count,
      [=] __device__(std::size_t i) {
        closest[i] = closest_point(hierarchy, meshes, points[i], max_distance);
      },
      stream);
}
void launch_signed_distance(const BinaryHierarchy& hierarchy, const MeshTable& meshes, const Vec3f* points,
                            float* distances, std::size_t count, cudaStream_t stream) {
  launch(
      count, [=] __device__(std::size_t i) { distances[i] = signed_distance(hierarchy, meshes, points[i]); },
      stream);
}

}  // namespace kerf::cuda
