// From the triangles of the caller to the references that builders sort.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <kerf/build.hpp>

#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Throws `Error::index_out_of_range` or `Error::non_finite_vertex` if triangle `id` has an index that names
/// no vertex, or a coordinate that is not below `coordinate_limit`.
void check_triangle(const Geometry& geometry, std::uint32_t id);

struct ReferenceSummary {
  std::uint32_t count = 0;
  std::size_t degenerate_triangles = 0, non_finite_triangles = 0;
  Box3f box;
  Box3f doubled_centroids;  ///< bounds of lower plus upper corner of each reference
};

/// Writes one reference for each triangle of `geometry` that has an area to `references`, in the order of
/// their numbers, on all threads of the task arena that this is called in. There must be room for
/// `triangle_count()` references. Throws `Error::index_out_of_range` or, unless they are to be skipped,
/// `Error::non_finite_vertex`, which name the first triangle that is wrong.
ReferenceSummary write_references(const Geometry& geometry, NonFinite non_finite, Reference* references);

struct Input {
  std::vector<Reference> references;
  std::size_t degenerate_triangles = 0, non_finite_triangles = 0;
};

/// The same into a vector of its own.
Input make_references(const Geometry& geometry, NonFinite non_finite = NonFinite::refuse);

}  // namespace kerf
