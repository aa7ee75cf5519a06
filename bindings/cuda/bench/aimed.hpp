// Rays aimed at vertices and edges of a closed surface, made on the device.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <kerf/ray.hpp>

namespace kerf::cuda {

struct AimedSource {
  const Vec3f* vertices;
  const std::array<std::uint32_t, 3>* triangles;
  const Vec3f* inside;  ///< points inside the surface
  std::uint32_t triangle_count, inside_count;
  Vec3f center;
  float radius;  ///< of a sphere around `center` and far outside the surface's bounds
};

/// Rays `first .. first + count - 1` of a sequence, the same on every run: from a point inside through a
/// vertex, the middle of an edge or a point of it and on without end; or, every second one, from a point
/// beyond the bounds on such a ray back to the point inside. Each must hit.
void make_aimed_rays(const AimedSource& source, std::uint64_t first, std::uint32_t count, Ray* rays);

/// Adds the number of misses to `*misses`; all memory of the device.
void count_misses(const Hit* hits, std::uint32_t count, unsigned long long* misses);
void count_misses(const std::uint8_t* results, std::uint32_t count, unsigned long long* misses);

}  // namespace kerf::cuda
