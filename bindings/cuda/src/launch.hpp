// How kernels are started: from plain C++, with pointers to memory of the device.
#pragma once

#include <cstddef>
#include <cstdint>

#include <driver_types.h>
#include <kerf/query.hpp>
#include <kerf/ray.hpp>

#include "binary_layout.hpp"
#include "trace.hpp"

namespace kerf::cuda {

/// What all rays together did.
struct TotalCounters {
  unsigned long long nodes = 0, triangles = 0;
};

void launch_closest(const BinaryHierarchy& hierarchy, const MeshTable& meshes, const Ray* rays, Hit* hits,
                    std::size_t count, cudaStream_t stream);
void launch_any(const BinaryHierarchy& hierarchy, const Ray* rays, std::uint8_t* occluded, std::size_t count,
                cudaStream_t stream);
void launch_counted(const BinaryHierarchy& hierarchy, const Ray* rays, std::size_t count, bool any_hit,
                    TotalCounters* totals, cudaStream_t stream);
void launch_count_hits(const BinaryHierarchy& hierarchy, const Ray* rays, std::uint32_t* counts,
                       std::size_t count, cudaStream_t stream);
void launch_list_hits(const BinaryHierarchy& hierarchy, const MeshTable& meshes, const Ray* rays,
                      const std::uint64_t* offsets, Hit* hits, std::size_t count, cudaStream_t stream);
void launch_contains(const BinaryHierarchy& hierarchy, const Vec3f* points, std::uint8_t* inside,
                     std::size_t count, cudaStream_t stream);
void launch_closest_point(const BinaryHierarchy& hierarchy, const MeshTable& meshes, const Vec3f* points,
                          SurfacePoint* closest, std::size_t count, float max_distance, cudaStream_t stream);
void launch_signed_distance(const BinaryHierarchy& hierarchy, const MeshTable& meshes, const Vec3f* points,
                            float* distances, std::size_t count, cudaStream_t stream);

}  // namespace kerf::cuda
