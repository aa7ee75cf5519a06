// A ray's crossings as the caller sees them.
#pragma once

#include "crossings.hpp"
#include "trace.hpp"

namespace kerf::cuda {

/// The first `room` crossings into `hits`, misses behind the last.
KERF_CUDA_INLINE void list_crossings(const BinaryHierarchy& hierarchy, const MeshTable& meshes,
                                     const Ray& ray, Hit* hits, std::uint64_t room) {
  std::uint64_t listed = 0;
  if (room != 0)
    for_each_crossing(hierarchy, ray, [&](const CrossingPlace& crossing, float u, float v) {
      const PrimitiveId place = meshes.locate(crossing.triangle);
      Hit& hit = hits[listed];
      hit.t = crossing.t;
      hit.u = u;
      hit.v = v;
      hit.primitive = place.primitive;
      hit.mesh = place.mesh;
      return ++listed < room;
    });
  for (; listed < room; ++listed) hits[listed] = Hit{};
}

}  // namespace kerf::cuda
