// Many rays on one thread: packets while rays are coherent, interleaved rays otherwise. Where vectors are too
// short for packets (KERF_PACKETS), rays are traced one by one. Included once per instruction set: see
// simd/README.md.

#if defined(KERF_TRAVERSAL_RAYS_MANY_RAYS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_RAYS_MANY_RAYS_INL_H
#undef KERF_TRAVERSAL_RAYS_MANY_RAYS_INL_H
#else
#define KERF_TRAVERSAL_RAYS_MANY_RAYS_INL_H
#endif

#include <algorithm>
#include <cstdint>

#include <hwy/highway.h>

#include "simd/targets.hpp"
#include "traversal/rays/batch.hpp"
#include "traversal/rays/interleaved-inl.h"
#include "traversal/rays/packet-inl.h"
#include "traversal/rays/single_ray-inl.h"

#if KERF_PACKETS
HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// Interleaving hides the latency of memory. The nodes and leaves of a hierarchy of up to this many bytes are
// close enough to the core for single rays, which take several nodes per step (docs/decisions/0054).
constexpr std::size_t max_single_bytes = std::size_t{5} << 20;

// Exponential back-off after incoherent packets: each time, twice as many are skipped before the next is
// tried, up to this many.
constexpr std::uint32_t max_skipped_packets = 32;

// Up to `rays_per_batch` rays. `finish(i, hit)` is called once per ray.
template <bool any_hit, class Finish>
HWY_INLINE void trace_batch(const WideBvh& bvh, const Ray* rays, std::uint32_t count, Finish&& finish) {
  Packet<any_hit> packet(bvh);
  std::uint32_t incoherent[rays_per_batch], incoherent_count = 0;
  std::uint32_t skip = 0, next_skip = 1;  // packets to skip now, and after the next incoherent one
  std::uint32_t i = 0;
  for (; i + packet.width <= count; i += packet.width) {
    if (skip == 0 && packet.set(rays + i)) {
      packet.run([&](std::size_t lane, const Hit& hit) HWY_ATTR { finish(i + lane, hit); });
      if (packet.was_coherent()) {
        next_skip = 1;
      } else {
        skip = next_skip;
        next_skip = std::min(2 * next_skip, max_skipped_packets);
      }
    } else {
      for (std::uint32_t lane = 0; lane < packet.width; ++lane) incoherent[incoherent_count++] = i + lane;
      skip -= skip > 0;
    }
  }
  for (; i < count; ++i) incoherent[incoherent_count++] = i;
  if (incoherent_count == 0) return;
  if (bvh.node_bytes() + bvh.leaves.size_bytes() <= max_single_bytes) {
    for (std::uint32_t k = 0; k < incoherent_count; ++k)
      finish(incoherent[k], trace_any_ray<any_hit, false>(bvh, rays[incoherent[k]], nullptr));
    return;
  }
  Interleaved<any_hit> interleaved(bvh, rays, incoherent, incoherent_count);
  interleaved.run(finish, [&](const Ray& ray) HWY_ATTR {
    return trace_prepared<any_hit, false>(bvh, ray, NoFilter(), nullptr);
  });
}

template <bool any_hit, class Finish>
HWY_INLINE void trace_many(const WideBvh& bvh, const Ray* rays, std::size_t count, Finish&& finish) {
  for (std::size_t begin = 0; begin < count; begin += rays_per_batch) {
    trace_batch<any_hit>(bvh, rays + begin,
                         static_cast<std::uint32_t>(std::min(rays_per_batch, count - begin)),
                         [&](std::size_t i, const Hit& hit) HWY_ATTR { finish(begin + i, hit); });
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();
#endif

#endif
