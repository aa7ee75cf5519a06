// What the calls of `Bvh` take, made on the device from arrays of other forms.
#pragma once

#include <cstddef>
#include <cstdint>

#include <kerf/batch.hpp>
#include <kerf/cuda/bvh.hpp>
#include <kerf/ray.hpp>

namespace kerf::cuda {

/// `rays[i]` becomes ray i of `columns`, whose addresses are memory of the device and whose masks are not
/// read. A column without an address has the number of `otherwise` for all rays. Starts one kernel on
/// `stream`, and throws `Error` where CUDA reports one.
void gather_rays(const RayView& columns, const Ray& otherwise, Ray* rays, Stream stream = nullptr);

/// `offsets[i]` becomes the sum of the first i of `count` counts, for i up to `count`: as `Bvh::list_hits`
/// takes it. Starts kernels on `stream` and takes memory there, which it gives back behind them.
void sum_counts(const std::uint32_t* counts, std::uint64_t* offsets, std::size_t count,
                Stream stream = nullptr);

}  // namespace kerf::cuda
