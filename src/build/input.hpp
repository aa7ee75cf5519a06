// From what the caller gave to what builders sort.
#pragma once

#include <cstddef>
#include <kerf/build.hpp>
#include <vector>

#include "tree/geometry.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Throws `Error::invalid_argument`, which names the option that is out of its range.
void check_options(const BuildOptions& options);

struct Input {
  std::vector<Reference>
      references;  ///< one for each triangle that has an area, in the order of their numbers
  std::size_t degenerate_triangles = 0;
};

/// Throws `Error::index_out_of_range` or `Error::non_finite_vertex`, which name the first that is wrong.
Input make_references(const Geometry& geometry);

}  // namespace kerf
