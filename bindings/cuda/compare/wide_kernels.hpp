// How the wide tree's kernels are started: from plain C++, with pointers to memory of the device.
#pragma once

#include "../src/launch.hpp"
#include "wide_layout.hpp"

namespace kerf::cuda {

void launch_wide_closest(const WideHierarchy& hierarchy, const MeshTable& meshes, const Ray* rays, Hit* hits,
                         std::size_t count, cudaStream_t stream);
void launch_wide_any(const WideHierarchy& hierarchy, const Ray* rays, std::uint8_t* occluded,
                     std::size_t count, cudaStream_t stream);
void launch_wide_counted(const WideHierarchy& hierarchy, const Ray* rays, std::size_t count, bool any_hit,
                         TotalCounters* totals, cudaStream_t stream);

}  // namespace kerf::cuda
