// Every crossing of a ray, in order, without memory beyond a few numbers for each ray.
#pragma once

#include <kerf/ray.hpp>

#include "line_crossing.hpp"
#include "ray_crossing.hpp"
#include "visit_line.hpp"

namespace kerf::cuda {

/// What the order of crossings goes by: t, then the triangle's number.
struct CrossingPlace {
  float t;
  std::uint32_t triangle;
};
KERF_CUDA_INLINE bool is_before(const CrossingPlace& a, const CrossingPlace& b) {
  return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
}

/// The first few crossings of a ray behind a given place. A triangle with several references is found in each
/// that the ray meets, always at the same place, which is kept once.
template <int capacity>
class NextCrossings {
 public:
  int count;
  CrossingPlace place[capacity];
  float u[capacity], v[capacity];

  /// `ray` prepared is `traced`.
  KERF_CUDA_INLINE void find(const BinaryHierarchy& hierarchy, const Ray& ray, const TracedRay& traced,
                             const CrossingPlace& after) {
    count = 0;
    const double scale = scale_of(ray.direction, is_far(ray, *hierarchy.bounds));
    const float from =
        after.t < -FLT_MAX ? traced.t_min : standard_max(traced.t_min, lowered(after.t * scale));
    float to = traced.t_max;
    visit_line(hierarchy, traced, from, to, [&](const DeviceTriangle& triangle) {
      const Corners corners = corners_of(triangle);
      if (!line_crosses(ray.origin, ray.direction, corners)) return;
      const RayCrossing crossing = crossing_of(ray.origin, ray.direction, corners);
      const CrossingPlace found{crossing.t, number_of(triangle)};
      if (!(crossing.t >= ray.t_min && crossing.t <= ray.t_max) || !is_before(after, found) ||
          found.triangle == invalid_id)
        return;
      insert(found, crossing.u, crossing.v);
      if (count == capacity) to = standard_min(to, raised(place[capacity - 1].t * scale));
    });
  }

 private:
  // A t in lengths of the prepared direction, as a bound: rounded to the safe side and in the range of a
  // float.
  KERF_CUDA_INLINE static float lowered(double t) { return -raised(-t); }
  KERF_CUDA_INLINE static float raised(double t) {
    const double size = t < 0.0 ? -t : t, highest = static_cast<double>(FLT_MAX);
    const double more = t + size * 0x1p-20 + 0x1p-126;
    return static_cast<float>(standard_max(standard_min(more, highest), -highest));
  }

  KERF_CUDA_INLINE void insert(const CrossingPlace& found, float found_u, float found_v) {
    int at = count;
    while (at > 0 && is_before(found, place[at - 1])) --at;
    if (at > 0 && !is_before(place[at - 1], found)) return;  // the same triangle
    if (at == capacity) return;
    if (count < capacity) ++count;
    for (int i = count - 1; i > at; --i) {
      place[i] = place[i - 1];
      u[i] = u[i - 1];
      v[i] = v[i - 1];
    }
    place[at] = found;
    u[at] = found_u;
    v[at] = found_v;
  }
};

/// Calls `visit(place, u, v)` for each triangle that the ray crosses, once, in order, until `visit` returns
/// false.
template <class Visit>
KERF_CUDA_INLINE void for_each_crossing(const BinaryHierarchy& hierarchy, const Ray& ray, Visit&& visit) {
  constexpr int at_once = 8;
  TracedRay traced;
  if (!prepare(&ray, hierarchy.bounds, traced)) return;
  CrossingPlace last{-std::numeric_limits<float>::infinity(), 0};
  NextCrossings<at_once> next;
  do {
    next.find(hierarchy, ray, traced, last);
    for (int i = 0; i < next.count; ++i)
      if (!visit(next.place[i], next.u[i], next.v[i])) return;
    if (next.count != 0) last = next.place[next.count - 1];
  } while (next.count == at_once);
}

KERF_CUDA_INLINE std::uint32_t count_crossings(const BinaryHierarchy& hierarchy, const Ray& ray) {
  std::uint32_t count = 0;
  for_each_crossing(hierarchy, ray, [&](const CrossingPlace&, float, float) {
    ++count;
    return true;
  });
  return count;
}

}  // namespace kerf::cuda
