// Questions about points.
#pragma once

#include <cstddef>
#include <vector>

#include <kerf/batch.hpp>
#include <kerf/query.hpp>

#include "queries/batches.hpp"
#include "structure.hpp"
#include "traversal/points/near_triangle.hpp"

namespace kerf {

/// Calls `answer(i, point)` for each point, in batches on as many threads as the options say.
template <class Answer>
void for_each_point(const PointView& points, const BatchOptions& options, const Answer& answer) {
  for_each_batch(points.size(), points_per_batch, options, [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i) answer(i, points[i]);
  });
}

/// What callers are told about a triangle near a point.
SurfacePoint surface_point(const Structure& structure, const NearTriangle& near);

/// As `Bvh::closest_point`; none converts to false.
SurfacePoint closest_point(const Structure& structure, const Vec3f& point, float max_distance);

}  // namespace kerf
