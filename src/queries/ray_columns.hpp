// Between the columns that callers have and the rays and hits that kernels take.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include <kerf/batch.hpp>

#include "traversal/rays/batch.hpp"

namespace kerf {

/// The address of element `i`.
template <class T>
auto address(const Column<T>& column, std::size_t i) {
  using Byte = std::conditional_t<std::is_const_v<T>, const std::byte, std::byte>;
  return reinterpret_cast<Byte*>(column.data) + static_cast<std::ptrdiff_t>(i) * column.stride;
}

inline float read(const Column<const float>& column, std::size_t i) {
  float value;
  std::memcpy(&value, address(column, i), sizeof value);
  return value;
}
inline Mask mask_at(const RayView& rays, std::size_t i) {
  Mask mask;
  if (rays.mask.data != nullptr) std::memcpy(&mask.bits, address(rays.mask, i), sizeof mask.bits);
  return mask;
}
template <class T>
void write(const Column<T>& column, std::size_t i, T value) {
  if (column.data != nullptr) std::memcpy(address(column, i), &value, sizeof value);
}

inline Ray ray_at(const RayView& rays, std::size_t i) {
  Ray ray;
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = read(rays.origin[axis], i);
    ray.direction[axis] = read(rays.direction[axis], i);
  }
  if (rays.t_min.data != nullptr) ray.t_min = read(rays.t_min, i);
  if (rays.t_max.data != nullptr) ray.t_max = read(rays.t_max, i);
  return ray;
}

inline void write_hit(const HitView& hits, std::size_t i, const Hit& hit) {
  write(hits.t, i, hit.t);
  write(hits.u, i, hit.u);
  write(hits.v, i, hit.v);
  write(hits.primitive, i, hit.primitive);
  write(hits.mesh, i, hit.mesh);
}

/// The array of `Ray` that the columns are, or null if they are none.
inline const Ray* as_array(const RayView& rays) {
  const float* const first = rays.origin[0].data;
  if (first == nullptr) return nullptr;
  const Column<const float>* const columns[] = {&rays.origin[0],    &rays.origin[1],    &rays.origin[2],
                                                &rays.direction[0], &rays.direction[1], &rays.direction[2],
                                                &rays.t_min,        &rays.t_max};
  static_assert(sizeof(Ray) == sizeof columns / sizeof columns[0] * sizeof(float));
  std::ptrdiff_t place = 0;
  for (const auto* column : columns)
    if (column->data != first + place++ || column->stride != sizeof(Ray)) return nullptr;
  const bool aligned = reinterpret_cast<std::uintptr_t>(first) % alignof(Ray) == 0;
  return aligned ? reinterpret_cast<const Ray*>(first) : nullptr;
}

/// The array of `Hit` that the columns are, or null if they are none.
inline Hit* as_array(const HitView& hits) {
  float* const first = hits.t.data;
  if (first == nullptr) return nullptr;
  constexpr auto stride = static_cast<std::ptrdiff_t>(sizeof(Hit));
  const bool beside = hits.u.data == first + 1 && hits.v.data == first + 2 &&
                      reinterpret_cast<float*>(hits.primitive.data) == first + 3 &&
                      reinterpret_cast<float*>(hits.mesh.data) == first + 4;
  const bool strided = hits.t.stride == stride && hits.u.stride == stride && hits.v.stride == stride &&
                       hits.primitive.stride == stride && hits.mesh.stride == stride;
  const bool aligned = reinterpret_cast<std::uintptr_t>(first) % alignof(Hit) == 0;
  return beside && strided && aligned ? reinterpret_cast<Hit*>(first) : nullptr;
}

/// Calls `use(rays)` with an array of up to `rays_per_batch` rays of the view, which lies in the caller's
/// memory if the view is one.
template <class Use>
void with_rays(const RayView& rays, std::size_t begin, std::size_t count, const Use& use) {
  if (const Ray* const array = as_array(rays)) return use(array + begin);
  Ray copies[rays_per_batch];  // 32 KiB
  for (std::size_t i = 0; i < count; ++i) copies[i] = ray_at(rays, begin + i);
  use(static_cast<const Ray*>(copies));
}

}  // namespace kerf
