// What a traversal knows of the hits along its ray.
#pragma once

#include "traversal.hpp"

namespace kerf::cuda {

/// Where single precision leaves open which hit is the nearest, `exact` decides it at once; else that is done
/// at the end, if it still matters then.
template <bool any_hit, bool exact, bool counting>
struct HitSearch {
  NearestHit nearest{};
  Counters counters;

  KERF_CUDA_INLINE void begin(const TracedRay& ray) {
    nearest = {ray.t_max, ray.t_max, invalid_id};
    open_ = decided_t;
    rival_ = invalid_id;
  }
  /// Nothing is searched here: all is left to be decided at the end, or nothing is to be found.
  KERF_CUDA_INLINE void skip(bool open) {
    nearest = {0.0f, 0.0f, invalid_id};
    open_ = open ? -FLT_MAX : decided_t;
    rival_ = invalid_id;
  }

  /// Tests `count` triangles from `first` on. True for a ray that needs no more.
  KERF_CUDA_INLINE bool test(const TracedRay& ray, const SceneBounds* scene, const DeviceTriangle* triangles,
                             std::uint32_t first, std::uint32_t count) {
    if constexpr (counting) counters.triangles += count;
    const std::uint32_t end = first + count;
    for (std::uint32_t place = first; place < end && !(any_hit && nearest.found()); ++place) {
      const float open = test_triangle<any_hit>(ray, triangles, place, nearest);
      if constexpr (exact) {
        if (open < decided_t) nearest = nearer_of(ray.source, scene, ray.t_min, triangles, place, nearest);
      } else {
        if (open < decided_t) remember(triangles, place, open);
      }
    }
    return any_hit && nearest.found();
  }

  /// Whether something is still open at the end: of the triangle `rival`, or of several if that is none.
  KERF_CUDA_INLINE bool open() const {
    return any_hit ? !nearest.found() && open_ < decided_t : open_ <= nearest.last;
  }
  KERF_CUDA_INLINE std::uint32_t rival() const { return rival_; }

 private:
  KERF_CUDA_INLINE void remember(const DeviceTriangle* triangles, std::uint32_t place, float open) {
    const bool alone = !(open_ <= nearest.last) ||
                       (rival_ != invalid_id && number_of(triangles[rival_]) == number_of(triangles[place]));
    rival_ = alone ? place : invalid_id;
    open_ = alone ? open : minimum(open_, open);
  }

  float open_;           // no triangle that single precision left open has a t below this
  std::uint32_t rival_;  // the only one of these that matters; `invalid_id` where several may
};

}  // namespace kerf::cuda
