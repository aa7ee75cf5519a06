#include "construction/construct.hpp"

#include <kerf/layout.hpp>

#include "base/raise.hpp"
#include "construction/builders.hpp"
#include "construction/options.hpp"

namespace kerf {

BinaryTree construct(const Geometry& geometry, const BuildOptions& options) {
  if (geometry.triangle_count() > ChildLink::max_place) {
    raise(Error::too_large, "the meshes have 2^28 triangles or more, which is more than kerf can number");
  }
  check_options(options);
  return find_builder(options.builder)->construct(geometry, options);
}

}  // namespace kerf
